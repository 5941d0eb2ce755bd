// SPDX-License-Identifier: MIT
// Text in columns of a terminal. A character is a code point of UTF-8 and one column wide.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace tandem::compare {

constexpr std::size_t line_columns = 100;

/// Characters of a text.
std::size_t width_of(std::string_view text);

/// Lines of at most `width` characters, broken at spaces, and inside words that are longer. At least one
/// line.
std::vector<std::string> wrap(std::string_view text, std::size_t width);

/// wrap() to a line's columns; lines after the first begin with `indent` spaces. Each line ends.
std::string paragraph(std::string_view text, std::size_t indent);

constexpr std::size_t table_columns = 7;
using TableRow = std::array<std::string, table_columns>;

/// Rows in columns, two spaces between, in a line's columns. The first and the last but one are aligned to
/// the left, the others to the right. What is too long for the first stands in a line above.
std::string table(const std::vector<TableRow>& rows);

/// A text in one line: control characters become spaces, and what is longer than `most` bytes is cut.
std::string one_line(std::string text, std::size_t most);

} // namespace tandem::compare
