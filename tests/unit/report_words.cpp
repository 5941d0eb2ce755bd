// SPDX-License-Identifier: MIT
// What a page says of records: groups, ranks, sentences, what there is no room for.
#include "harness/report/data.h"
#include "harness/report/groups.h"
#include "harness/report/page.h"

#include <gmock/gmock.h>

namespace tandem::report {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A cell with these times of its rounds, in ms of its one frame.
ShownCell cell_of(const std::string& algorithm, const std::vector<double>& rounds,
                  const std::string& k = "18") {
    ShownCell cell;
    auto& recorded = cell.recorded;
    recorded.key = algorithm + "|k=" + k;
    recorded.status = "ok";
    recorded.names = {{"algorithm", algorithm}, {"preset", "resident"}, {"devices", "cuda:0"},
                      {"model", "GPU"},         {"driver", "1"},        {"scene", "pile"},
                      {"frames", "frames 0:0"}, {"handling", ""},       {"digest", "digest 1"}};
    recorded.settings = {{"k", k}};
    recorded.on_gpus = true;
    for (std::size_t i = 0; i < rounds.size(); ++i)
        recorded.rounds.push_back({static_cast<std::int64_t>(i), rounds[i] * 1e6});
    cell.scene = "pile:bodies=3";
    cell.scene_name = "pile";
    cell.scene_digest = "1";
    for (std::size_t i = 0; i + 1 < cell_fields.size(); ++i) cell.row.push_back("text " + algorithm);
    return cell;
}

const std::vector<double> one_ms{1.0, 1.01, 0.99, 1.0, 1.02, 0.98, 1.0, 1.01, 0.99, 1.0};
const std::vector<double> two_ms{2.0, 2.02, 1.98, 2.0, 2.04, 1.96, 2.0, 2.02, 1.98, 2.0};

TEST(ReportWords, NameTheFastestAndByHowMuch) {
    const std::vector cells{cell_of("slow", two_ms), cell_of("quick", one_ms)};
    const auto groups = groups_of(cells);
    ASSERT_EQ(groups.size(), 1u);
    EXPECT_EQ(groups[0].title, "pile, frames 0:0, k = 18, on cuda:0 (GPU)");
    EXPECT_EQ(groups[0].ranked[0].cell, 1u);
    const auto words = words_of(groups[0], cells);
    EXPECT_THAT(
        words,
        HasSubstr("quick is the fastest of 2 with 1.000 ms a frame; the next, slow, takes 2.000 times"));
    EXPECT_THAT(words_of(groups, cells)[0],
                HasSubstr("quick is the fastest in 1 of 1 comparisons, told apart"));
}

TEST(ReportWords, SayWhatIsNotToldApart) {
    auto nearly = one_ms;
    std::swap(nearly[0], nearly[4]);
    nearly[1] += 0.002;
    const std::vector cells{cell_of("a", one_ms), cell_of("b", nearly)};
    const auto groups = groups_of(cells);
    EXPECT_FALSE(groups[0].ranked[1].is_told_apart);
    EXPECT_THAT(words_of(groups[0], cells), HasSubstr("is not told apart from it"));
}

TEST(ReportWords, OneRoundIsNotSure) {
    const std::vector cells{cell_of("a", {1.0}), cell_of("b", {2.0})};
    const auto groups = groups_of(cells);
    EXPECT_FALSE(groups[0].ranked[1].is_told_apart);
    EXPECT_THAT(words_of(groups[0], cells), HasSubstr("how sure is not known"));
}

TEST(ReportWords, FailedWrongAndOlderAreNeverRanked) {
    std::vector cells{cell_of("a", two_ms), cell_of("b", one_ms), cell_of("c", one_ms), cell_of("d", one_ms)};
    cells[1].recorded.status = "wrong";
    cells[2].recorded.status = "failed";
    cells[2].recorded.failure = "no memory";
    cells[3].is_older = true;
    const auto groups = groups_of(cells);
    ASSERT_EQ(groups[0].ranked.size(), 1u);
    EXPECT_EQ(groups[0].ranked[0].cell, 0u);
    const auto words = words_of(groups[0], cells);
    EXPECT_THAT(words, HasSubstr("b was wrong, and is not ranked"));
    EXPECT_THAT(words, HasSubstr("c failed, and is not ranked: no memory."));
    EXPECT_THAT(words_of(groups, cells)[0], HasSubstr("1 failed and 1 gave a wrong answer"));
}

TEST(ReportWords, OtherBoundsAreAnotherGroup) {
    const std::vector cells{cell_of("a", one_ms), cell_of("a", two_ms, "8")};
    EXPECT_EQ(groups_of(cells).size(), 2u);
}

TEST(ReportWords, DifferentAnswersHaveNoFastest) {
    std::vector cells{cell_of("a", one_ms), cell_of("b", two_ms)};
    cells[0].recorded.pairs = compare::Answer{3, "1", "2"};
    cells[1].recorded.pairs = compare::Answer{4, "1", "2"};
    const auto groups = groups_of(cells);
    EXPECT_THAT(words_of(groups[0], cells), HasSubstr("none is said to be the fastest"));
    EXPECT_THAT(words_of(groups, cells), testing::IsEmpty());
}

TEST(ReportData, LeavesOutTheLastCellsAndSaysSo) {
    Records records;
    for (int i = 0; i < 200; ++i) records.cells.push_back(cell_of("a" + std::to_string(i), one_ms));
    const auto [text, cells, notes] = data_of(std::move(records), 40'000);
    EXPECT_LT(text.size(), 50'000u);
    const auto json = Json::parse(text);
    EXPECT_LT(json["cells"].size(), 200u);
    EXPECT_GT(json["cells"].size(), 10u);
    EXPECT_EQ(json["cells"].size(), cells);
    EXPECT_EQ(json["notes"].size(), notes.size());
    EXPECT_THAT(json["notes"][0].get<std::string>(), HasSubstr("of 200 cells are left out"));
}

TEST(ReportPage, DataCannotEndItsElement) {
    const Page page{.title = "<b> & c", .data = {{"records", R"({"a":"</script><!--<img>"})"}}};
    const auto html = html_of(page);
    EXPECT_THAT(html, HasSubstr(R"({"a":"\u003c/script>\u003c!--\u003cimg>"})"));
    EXPECT_THAT(html, Not(HasSubstr("<img>")));
    EXPECT_THAT(html, HasSubstr("<title>&lt;b> &amp; c</title>"));
    EXPECT_THAT(html, HasSubstr("default-src 'none'"));
}

} // namespace
} // namespace tandem::report
