// SPDX-License-Identifier: MIT
#include "base/text_lines.h"

#include <algorithm>
#include <cstdint>
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

struct Character {
    std::uint32_t code = 0;
    std::size_t bytes = 1;
};

/// The first character of a text that is not empty; a byte that is not UTF-8 is a character of its own.
Character first_character(std::string_view text) {
    const auto byte = static_cast<unsigned char>(text.front());
    const std::size_t bytes = byte < 0xc2u ? 1 : byte < 0xe0u ? 2 : byte < 0xf0u ? 3 : byte < 0xf5u ? 4 : 1;
    if (bytes == 1 || bytes > text.size()) return {byte, 1};
    std::uint32_t code = byte & (0xffu >> (bytes + 1));
    for (const char next : text.substr(1, bytes - 1)) {
        if (!is_continuation(next)) return {byte, 1};
        code = code << 6 | (static_cast<unsigned char>(next) & 0x3fu);
    }
    return {code, bytes};
}

/// C0, C1, marks of direction (Unicode Bidi_Control), and separators of lines and paragraphs.
bool is_control(std::uint32_t code) {
    return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x61c || code == 0x200e || code == 0x200f
           || (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
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

std::string paragraph(std::string_view text, std::size_t indent, std::size_t width) {
    const auto first = wrap(text, width).front();
    const auto rest = text.substr(first.size());
    const auto rest_begins = rest.find_first_not_of(' ');
    std::string result = first + "\n";
    if (rest_begins == std::string_view::npos) return result;
    for (const auto& line : wrap(rest.substr(rest_begins), width - indent))
        result += std::string(indent, ' ') + line + "\n";
    return result;
}

std::string shortened(std::string_view text, std::size_t width) {
    if (width_of(text) <= width || width == 0) return std::string(text);
    return std::string(text.substr(0, bytes_of(text, width - 1))) + "…";
}

std::string visible(std::string_view text, std::string_view kept) {
    std::string shown;
    while (!text.empty()) {
        const auto [code, bytes] = first_character(text);
        const auto own = text.substr(0, bytes);
        if (kept.find(text.front()) != kept.npos || !is_control(code))
            shown += own;
        else if (text.front() == '\n')
            shown += "\\n";
        else if (text.front() == '\t')
            shown += "\\t";
        else
            shown +=
                code != 0x7f && bytes == 1 ? fmt::format("\\x{:02x}", code) : fmt::format("\\u{:04x}", code);
        text.remove_prefix(bytes);
    }
    return shown;
}

} // namespace tandem
