// SPDX-License-Identifier: MIT
// What people read in a terminal: widths, units of columns, and the time left.
#include "base/progress.h"
#include "base/text_lines.h"
#include "base/columns.h"
#include "harness/sampling/time_left.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using testing::ElementsAre;

TEST(Terminal, ATextIsShortenedByCharacters) {
    EXPECT_EQ(shortened("± 12", 4), "± 12");
    EXPECT_EQ(shortened("± 123", 4), "± 1…");
}

TEST(Terminal, ProgressNamesTheFractionOfTheTime) {
    EXPECT_EQ(progress_text(65, std::nullopt), "[1:05]");
    EXPECT_EQ(progress_text(30, 90), "[25 %, 0:30, 1:30 left]");
    EXPECT_EQ(progress_text(7200, 0), "[100 %, 2:00:00, 0:00 left]");
}

/// What is printed when the text is shown twice, as in a log.
std::string logged(const Progress& progress) {
    testing::internal::CaptureStderr();
    for (const auto* text : {"one", "two"}) progress.show(text, 90);
    progress.clear();
    return testing::internal::GetCapturedStderr();
}

TEST(Terminal, ProgressIsALineEveryPeriodInALog) {
    EXPECT_EQ(logged(Progress(false, 0)), "[0 %, 0:00, 1:30 left] one\n[0 %, 0:00, 1:30 left] two\n");
    EXPECT_EQ(logged(Progress(false)), "");
    EXPECT_EQ(logged(Progress(true, 0)), "");
}

TEST(Terminal, AColumnOfAmountsHasOneUnit) {
    const auto column = [](const std::vector<std::optional<double>>& amounts) {
        return amounts_column("pairs", amounts);
    };
    EXPECT_EQ(column({99'999, 7}).head, "pairs");
    EXPECT_THAT(column({99'999, 7}).texts, ElementsAre("99999", "7"));
    EXPECT_EQ(column({430'300, 0}).head, "M pairs");
    EXPECT_THAT(column({430'300, 0}).texts, ElementsAre("0.4303", "0.0000"));
    EXPECT_EQ(column({2e9, 123'456}).head, "M pairs"); // in G the second would lose its digits
    EXPECT_THAT(column({2e9, 123'456}).texts, ElementsAre("2000.0000", "0.1235"));
    EXPECT_EQ(column({2e9, 12}).head, "pairs");
    EXPECT_THAT(column({0.0, 0.0}).texts, ElementsAre("", ""));
    EXPECT_THAT(column({std::nullopt, 12.5}).texts, ElementsAre("-", "12.50"));
}

TEST(Terminal, AColumnOfTimesHasEquallyManyDecimals) {
    EXPECT_THAT(millisecond_texts({1.25, 150}), ElementsAre("1.250", "150.000"));
    EXPECT_THAT(millisecond_texts({101.25, 150, 0}), ElementsAre("101.2", "150.0", "0.0"));
    EXPECT_THAT(millisecond_texts({0.0123, 0}), ElementsAre("0.01230", "0.00000"));
}

TEST(Terminal, MarkdownHasOneLineARow) {
    const auto text =
        in_columns({"a|b", "c"}, "cell", {{"ms", {"1", "2"}}, {"empty", {"", ""}}}, TableFormat::markdown);
    EXPECT_EQ(text, "| cell | ms |\n|---|---:|\n| a\\|b | 1 |\n| c | 2 |\n");
}

/// Two cells, of which the first is half checked after 4 s: 4 s are left of its check, and 8 s of the other.
TEST(Terminal, TheTimeLeftCountsChecks) {
    std::array<CellWork, 2> cells{{{{4, 0.5}, {}}, {}}};
    EXPECT_EQ(seconds_left(cells, 0, 10), 4 + 8 + 20);
    EXPECT_EQ(seconds_left(cells, 1, 10), 4 + 8 + 8 + 30);
    EXPECT_EQ(seconds_left(cells, 0, std::nullopt), std::nullopt);
    cells[0] = {{8, 1}, {3, 0.25}};
    EXPECT_EQ(seconds_left(cells, 0, 10), 8 + 9 + 12); // rounds take as long as those of the first cell
    EXPECT_EQ(seconds_left(std::array<CellWork, 1>{}, 0, 10), std::nullopt);
}

} // namespace
} // namespace tandem
