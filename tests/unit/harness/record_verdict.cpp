// SPDX-License-Identifier: MIT
#include "algorithms/traversal.h"
#include "backends/registry.h"
#include "harness/plans/cells.h"
#include "harness/frames/frames.h"
#include "harness/record/verdict.h"
#include "scenes/scene.h"

#include <deque>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tandem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// Cells of one run with made-up times.
class RecordVerdict : public testing::Test {
protected:
    /// Adds a cell with one sample for each round.
    Measurement& add(const std::vector<std::int64_t>& times, const std::string& k = "8") {
        const auto& chosen = algorithm("tiled");
        cells_.push_back(make_cell(chosen, chosen.presets().front(), {{"k", k}},
                                   {backends_.front().devices.front().get()}));
        auto& m = measurements_.emplace_back();
        m.settings = cells_.back().settings;
        for (std::uint32_t round = 0; round < times.size(); ++round)
            m.samples.push_back({.round = round, .frame_ns = {times[round]}});
        m.candidate_pairs = {5};
        rows_.push_back({&cells_.back(), &m, std::string(1, static_cast<char>('a' + rows_.size()))});
        return m;
    }

    Verdict verdict() const { return verdicts_of(rows_).at(0); }

    static std::vector<std::size_t> order(const Verdict& verdict) {
        std::vector<std::size_t> rows;
        for (const auto& cell : verdict.cells) rows.push_back(cell.row);
        return rows;
    }

    std::string sentence() const {
        const std::vector<std::string> labels{"A", "B", "C"};
        return verdict_sentence(verdict(), rows_, labels);
    }

    const std::vector<std::string> wanted_{"host"};
    const std::vector<BackendReport> backends_ = discover(wanted_);
    std::deque<Cell> cells_; ///< rows point to cells and measurements
    std::deque<Measurement> measurements_;
    std::vector<Row> rows_;
};

TEST_F(RecordVerdict, TheFastestIsFirstAndOthersFollowByTheirRatios) {
    add({3000000, 3000001, 3000000, 3000000, 3000000});
    add({1000000, 1000001, 1000000, 1000000, 1000000});
    add({2000000, 2000001, 2000000, 2000000, 2000000});
    EXPECT_THAT(order(verdict()), ElementsAre(1, 2, 0));
    EXPECT_NEAR(verdict().cells[1].ratio.value, 2, 1e-6);
    EXPECT_TRUE(verdict().cells[1].is_told_apart());
    EXPECT_EQ(sentence(), "B is fastest: 1.000 ms per frame, 2 times as fast as C [2, 2]. "
                          "The slowest, A, takes 3 times as long [3, 3].");
}

TEST_F(RecordVerdict, SeveralVerdictsSayOfWhichBounds) {
    for (const auto* k : {"8", "18"})
        for (const std::int64_t ns : {1000000, 2000000}) add({ns, ns, ns}, k);
    const auto verdicts = verdicts_of(rows_);
    ASSERT_EQ(verdicts.size(), 2u);
    EXPECT_EQ(verdict_scope(verdicts[0], verdicts, rows_), "k=8: ");
    EXPECT_EQ(verdict_scope(verdicts[1], verdicts, rows_), "k=18: ");
    EXPECT_EQ(verdict_scope(verdicts[0], std::span(verdicts).first(1), rows_), "");
}

TEST_F(RecordVerdict, AnIntervalWithOneLeavesTwoLeaders) {
    add({1000000, 1100000, 1000000, 1100000, 1000000});
    add({1100000, 1000000, 1100000, 1000000, 1100000});
    const auto found = verdict();
    EXPECT_TRUE(found.is_leader(found.cells[0]) && found.is_leader(found.cells[1]));
    EXPECT_THAT(sentence(), HasSubstr("A and B cannot be told apart with 5 rounds (ratio ["));
    EXPECT_THAT(sentence(), HasSubstr("try --repeat 20"));
}

TEST_F(RecordVerdict, TheFastestIsSoByItsRatiosAlthoughAnotherHasTheLowestMedian) {
    add({1000000, 2000000, 3000000});
    add({900000, 2100000, 2800000});
    EXPECT_THAT(order(verdict()), ElementsAre(1, 0));
    EXPECT_GT(verdict().cells[1].ratio.value, 1);
}

TEST_F(RecordVerdict, OneRoundHasNoInterval) {
    add({1000000});
    add({2000000, 2000000});
    const auto scene = make_scene("plates");
    const auto line = verdict_record(verdict(), rows_, scene, FrameRange(scene, 0, 0));
    EXPECT_EQ(line["cells"][1]["rounds"], 1);
    EXPECT_TRUE(line["cells"][1]["low"].is_null() && line["cells"][1]["told_apart"].is_null());
    EXPECT_THAT(sentence(), HasSubstr("2 times as fast as B; --repeat 5 gives an interval"));
}

/// All four ratios lie on one side by chance in an eighth of all runs.
TEST_F(RecordVerdict, FourRoundsHaveNoInterval) {
    add({1000000, 1000001, 1000000, 1000000});
    add({2000000, 2000001, 2000000, 2000000});
    EXPECT_FALSE(verdict().cells[1].is_told_apart());
    EXPECT_THAT(sentence(), StartsWith("A took the least time, in fewer than 5 rounds: "));
}

TEST_F(RecordVerdict, OtherPairsHaveNoFastest) {
    add({1000000, 1000000});
    add({2000000, 2000000}).agreement.digest.a = 7;
    const auto found = verdict();
    EXPECT_TRUE(found.answers_differ);
    EXPECT_FALSE(found.is_leader(found.cells[0]));
    EXPECT_THAT(sentence(), HasSubstr("found different sets of candidate pairs"));
}

TEST_F(RecordVerdict, OnlyComparableCellsShareOne) {
    add({1000000, 1000000});
    add({2000000, 2000000}, "18");
    add({3000000, 3000000}).agreement.missing = 1;
    add({4000000, 4000000}).candidate_pairs = {0};
    EXPECT_TRUE(verdicts_of(rows_).empty());
    add({2000000, 2000000});
    EXPECT_THAT(order(verdict()), ElementsAre(0, 4));
}

} // namespace
} // namespace tandem
