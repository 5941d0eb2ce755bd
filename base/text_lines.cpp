// SPDX-License-Identifier: MIT
#include "base/text_lines.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Whether the byte continues a UTF-8 character.
bool is_continuation(char byte) { return (static_cast<unsigned char>(byte) & 0xc0u) == 0x80u; }

/// The length in bytes of the first `count` characters of a text, or of the whole text if it is shorter.
std::size_t bytes_of(std::string_view text, std::size_t count) {
    std::size_t bytes = 0;
    for (; bytes < text.size(); ++bytes)
        if (!is_continuation(text[bytes]) && count-- == 0) return bytes;
    return bytes;
}

} // namespace

std::size_t width_of(std::string_view text) {
    std::size_t count = 0;
    bool escape = false;
    for (const char byte : text) {
        if (byte == '\033') escape = true;
        if (!escape && !is_continuation(byte)) ++count;
        if (escape && byte == 'm') escape = false;
    }
    return count;
}

std::vector<std::string> wrap(std::string_view text, std::size_t width) {
    std::vector<std::string> lines;
    while (width_of(text) > width) {
        const auto limit = bytes_of(text, width);
        const auto space = text.substr(0, limit + 1).rfind(' ');
        const auto end = space == std::string_view::npos || space == 0 ? limit : space;
        lines.emplace_back(text.substr(0, end));
        text.remove_prefix(end);
        text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    }
    lines.emplace_back(text);
    return lines;
}

std::string paragraph(std::string_view text, std::size_t indent) {
    const auto first = wrap(text, line_columns).front();
    const auto rest = text.substr(first.size());
    const auto rest_begins = rest.find_first_not_of(' ');
    std::string result = first + "\n";
    if (rest_begins == std::string_view::npos) return result;
    for (const auto& line : wrap(rest.substr(rest_begins), line_columns - indent))
        result += std::string(indent, ' ') + line + "\n";
    return result;
}

std::string visible(std::string_view text) {
    std::string shown;
    for (const char byte : text) {
        const auto code = static_cast<unsigned char>(byte);
        if (byte == '\n')
            shown += "\\n";
        else if (byte == '\t')
            shown += "\\t";
        else if (code < ' ' || code == 0x7f)
            shown += fmt::format("\\x{:02x}", code);
        else
            shown += byte;
    }
    return shown;
}

} // namespace tandem
