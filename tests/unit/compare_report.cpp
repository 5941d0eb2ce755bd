// SPDX-License-Identifier: MIT
#include "tests/unit/compare_compared.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sstream>

namespace tandem::compare {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(TextLines, ControlCharactersAreShown) {
    EXPECT_EQ(visible("a\nb\tc\x1b[31m\x7f"), R"(a\nb\tc\x1b[31m\x7f)");
    EXPECT_EQ(visible("pile \u00e9"), "pile \u00e9");
}

TEST(TextLines, ColoursHaveNoWidth) {
    EXPECT_EQ(width_of("\033[1m1.0 \u00b1 0.1\033[0m ms"), 12u);
    EXPECT_EQ(wrap("one two  three", 7), (std::vector<std::string>{"one two", "three"}));
}

TEST(CompareReport, SaysWhatChangedInALineOfWords) {
    Records before;
    Records after;
    const std::vector<double> factors{1.2, 1.3, 1, 1.005, 0.5, 1};
    for (std::size_t i = 0; i < factors.size(); ++i) {
        before.push_back(record(std::to_string(i), around(1, 10)));
        after.push_back(record(std::to_string(i), around(factors[i], 10)));
    }
    after[5]["work"]["digest"]["count"] = 5;
    const Compared compared(before, after);
    EXPECT_THAT(
        summary(compared.report()),
        HasSubstr("2 of 6 cells slower, 1 faster beyond 1 % at level 0.05; 1 with another answer; 1 changed "
                  "within the threshold; the others could have shown 0."));
    const auto text = text_of(compared.report());
    EXPECT_THAT(text, HasSubstr("another answer: k=5: 5 candidate pairs for 3\n"));
    EXPECT_THAT(text, HasSubstr("1.200 [1.19"));
}

TEST(CompareReport, LinesHaveAHundredColumnsAtMost) {
    Records before;
    for (const std::size_t samples : {2, 9, 9}) {
        before.push_back(record(std::to_string(before.size()), around(1, samples)));
        before.back()["settings"]["x"] = std::string(150, 'x') + std::to_string(before.size());
    }
    before.push_back(record("é", around(1, 9)));
    auto after = before;
    after[1] = record("1", around(1.005, 9));
    after[1]["settings"] = before[1]["settings"];
    after.push_back(record("failed", {}));
    after.back()["status"] = "failed";
    after.back()["failure"] = std::string(500, 'y') + "\n\x1b[1m";
    after.back()["devices"][0]["name"] = std::string(90, 'z');
    std::istringstream text(text_of(Compared(before, after).report()));
    std::size_t most = 0;
    for (std::string line; std::getline(text, line);) {
        most = std::max(most, width_of(line));
        EXPECT_LE(width_of(line), line_columns) << line;
        EXPECT_THAT(line, Not(HasSubstr("\x1b")));
    }
    EXPECT_GT(most, 90u);
}

TEST(CompareReport, MarkdownKeepsItsCells) {
    const Records before{record("a|b", around(1, 9)), record("8", around(1, 9))};
    const auto text = markdown_of(Compared(before, before).report());
    EXPECT_THAT(text, HasSubstr("\n| k=a\\|b | 10.00 | 10.00 | 1.000 "));
    EXPECT_THAT(text, HasSubstr("|---|---:|"));
}

TEST(CompareReport, JsonHasEverything) {
    const Records before{in_rounds("8", around(1, 9), "s"), record("18", {1})};
    const auto json =
        nlohmann::json::parse(json_of(Compared(before, {in_rounds("8", around(1.5, 9), "s")}).report()));
    EXPECT_EQ(json.at("verdicts").at("slower"), 1);
    EXPECT_EQ(json.at("old").at("only_here"), nlohmann::json({"18"}));
    const auto& cell = json.at("cells").at(0);
    EXPECT_EQ(cell.at("key"), "8");
    EXPECT_EQ(cell.at("verdict"), "slower");
    EXPECT_EQ(cell.at("common_rounds"), 9);
    EXPECT_EQ(cell.at("times").at("test"), "signed ranks, exact");
    EXPECT_DOUBLE_EQ(cell.at("times").at("ratio"), 1.5);
    EXPECT_EQ(cell.at("old").at("seed"), 7);
}

} // namespace
} // namespace tandem::compare
