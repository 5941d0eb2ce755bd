// SPDX-License-Identifier: MIT
#include "base/text_lines.h"

#include "base/standard_streams.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

TEST(VisibleText, ControlCharactersAreEscapes) {
    EXPECT_EQ(visible("a\n\t\r\x1b[31m\x07\x7f"), "a\\n\\t\\x0d\\x1b[31m\\x07\\u007f");
    EXPECT_EQ(visible("\u009b \u061c \u200e \u2028 \u202e \u2066 \u2069"),
              "\\u009b \\u061c \\u200e \\u2028 \\u202e \\u2066 \\u2069");
    EXPECT_EQ(visible("a\nb\tc", "\n"), "a\nb\\tc");
}

TEST(VisibleText, OtherCharactersStay) {
    for (const auto* text : {"±→Ωé日本", "\u00a0\u2027\u202f\u2065\u206a\U0001f600", "\\n", ""})
        EXPECT_EQ(visible(text), text);
}

/// A terminal of one byte a character takes these bytes for C1.
TEST(VisibleText, BytesThatAreNotUtf8) {
    EXPECT_EQ(visible("\x9b\xe9t\xe9\x80"), "\\x9b\xe9t\xe9\\x80");
    EXPECT_EQ(visible("\xe2\x80"), "\xe2\\x80");
    EXPECT_EQ(visible("\xc0\x9b"), "\xc0\\x9b");
}

TEST(PrintedText, OnlyValuesAreEscaped) {
    EXPECT_EQ(printed("\033[1m{}\n{:>4} {}\n", "a\n\033", std::string("\t"), 3),
              "\033[1ma\\n\\x1b\n  \\t 3\n");
}

} // namespace
} // namespace tandem
