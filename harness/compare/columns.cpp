// SPDX-License-Identifier: MIT
#include "harness/compare/columns.h"

#include "harness/text_lines.h"

#include <algorithm>

namespace tandem::compare {

namespace {

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

} // namespace tandem::compare
