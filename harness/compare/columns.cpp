// SPDX-License-Identifier: MIT
#include "harness/compare/columns.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem::compare {

namespace {

/// Of UTF-8: bytes that go on with a character.
bool goes_on(char byte) { return (static_cast<unsigned char>(byte) & 0xc0u) == 0x80u; }

/// Bytes of the first characters of a text, `count` of them or all.
std::size_t bytes_of(std::string_view text, std::size_t count) {
    std::size_t bytes = 0;
    for (; bytes < text.size(); ++bytes)
        if (!goes_on(text[bytes]) && count-- == 0) return bytes;
    return bytes;
}

std::string padded(const std::string& text, std::size_t width, bool left) {
    const std::string space(width - std::min(width, width_of(text)), ' ');
    return left ? text + space : space + text;
}

constexpr std::string_view gap = "  ";

bool is_left(std::size_t column) { return column == 0 || column == table_columns - 2; }

/// Of every column; of the first so much as the others leave.
std::array<std::size_t, table_columns> widths_of(const std::vector<TableRow>& rows) {
    std::array<std::size_t, table_columns> widths{};
    std::size_t others = 0;
    for (std::size_t column = table_columns; column-- > 0;) {
        for (const auto& row : rows) widths[column] = std::max(widths[column], width_of(row[column]));
        if (column > 0) others += widths[column] + gap.size();
    }
    constexpr std::size_t least = 8;
    widths[0] = std::min(widths[0], std::max(least, line_columns - std::min(line_columns, others)));
    return widths;
}

} // namespace

std::size_t width_of(std::string_view text) {
    return static_cast<std::size_t>(std::ranges::count_if(text, [](char byte) { return !goes_on(byte); }));
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

std::string table(const std::vector<TableRow>& rows) {
    const auto widths = widths_of(rows);
    std::string text;
    for (const auto& row : rows) {
        const bool fits = width_of(row[0]) <= widths[0];
        if (!fits) text += paragraph(row[0], 2);
        auto line = padded(fits ? row[0] : "", widths[0], true);
        for (std::size_t column = 1; column < table_columns; ++column)
            line += std::string(gap) + padded(row[column], widths[column], is_left(column));
        text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    return text;
}

std::string one_line(std::string text, std::size_t most) {
    for (auto& byte : text)
        if (static_cast<unsigned char>(byte) < ' ' || byte == '\x7f') byte = ' ';
    if (text.size() <= most) return text;
    while (most > 0 && goes_on(text[most])) --most;
    return text.substr(0, most) + "...";
}

} // namespace tandem::compare
