// SPDX-License-Identifier: MIT
// Text in lines of a terminal. A character is a UTF-8 code point and one column wide; colour escapes have no
// width.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tandem {

/// The number of characters of a text.
std::size_t width_of(std::string_view text);

/// Splits a text into lines of at most `width` characters. Lines break at spaces, and inside a word only when
/// the word is longer than a line. Returns at least one line.
std::vector<std::string> wrap(std::string_view text, std::size_t width);

/// wrap() with lines after the first that begin with `indent` spaces, all of at most `width` characters. Each
/// line ends with a newline.
std::string paragraph(std::string_view text, std::size_t indent, std::size_t width);

/// The text, or its first `width` - 1 characters and "…" if it has more than `width`.
std::string shortened(std::string_view text, std::size_t width);

/// The text with control characters as \\n, \\x1b or \\u009b, so that words of a file cannot move a
/// terminal's cursor, end a line or reverse the order of letters: C0, C1, marks of direction and separators
/// of lines. A byte that is not UTF-8 and that a terminal could take for C1 is \\x9b. Characters in `kept`
/// stay.
std::string visible(std::string_view text, std::string_view kept = {});

} // namespace tandem
