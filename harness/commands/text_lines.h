// SPDX-License-Identifier: MIT
// Text in lines of a terminal. A character is a code point of UTF-8 and one column wide; escapes of colours
// have no width.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tandem {

constexpr std::size_t line_columns = 100;

/// Characters of a text.
std::size_t width_of(std::string_view text);

/// Lines of at most `width` characters, broken at spaces, and inside words that are longer. At least one
/// line.
std::vector<std::string> wrap(std::string_view text, std::size_t width);

/// wrap() to a line's columns; lines after the first begin with `indent` spaces. Each line ends.
std::string paragraph(std::string_view text, std::size_t indent);

/// A text with its control characters written out (\\n, \\x1b): what a file's own words make of a message.
std::string visible(std::string_view text);

} // namespace tandem
