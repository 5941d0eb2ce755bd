// SPDX-License-Identifier: MIT
// Text in lines of a terminal. A character is a UTF-8 code point and one column wide; colour escapes have no
// width.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tandem {

constexpr std::size_t line_columns = 100;

/// The number of characters of a text.
std::size_t width_of(std::string_view text);

/// Splits a text into lines of at most `width` characters. Lines break at spaces, and inside a word only when
/// the word is longer than a line. Returns at least one line.
std::vector<std::string> wrap(std::string_view text, std::size_t width);

/// wrap() to `line_columns`. Lines after the first begin with `indent` spaces. Each line ends with a newline.
std::string paragraph(std::string_view text, std::size_t indent);

/// The text with control characters written as \\n or \\x1b, for messages that contain text from a file.
std::string visible(std::string_view text);

} // namespace tandem
