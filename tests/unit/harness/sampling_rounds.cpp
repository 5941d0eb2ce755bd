// SPDX-License-Identifier: MIT
// Rounds of a group of cells: number and order of samples, the stopping criterion, and the effect of a
// failure.
#include "harness/sampling/rounds.h"

#include "backends/host/host_device.h"
#include "harness/sampling/local_sampler.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

#include <deque>

namespace tandem {
namespace {

using namespace support;
using testing::ElementsAre;

/// Cells of a small scene on the host, and their outcomes.
class SamplingRounds : public testing::Test {
protected:
    SamplingRounds() {
        for (const SettingTexts& given : {SettingTexts{{"k", "8"}},
                                          {{"k", "8"}, {"precision", "double"}},
                                          {{"k", "18"}}}) { // available in sanitized builds
            auto all = given;
            all["pair_capacity"] = all["contact_capacity"] = "4096";
            add(all);
        }
        check_.count_work = false;
    }

    void add(const SettingTexts& given, Device& on = device("host")) {
        const auto& tiled = algorithm("tiled");
        cells_.push_back(make_cell(tiled, tiled.presets().front(), given, {&on}));
    }

    bool sample(const StoppingCriterion& criterion, std::uint64_t seed = 1) {
        std::vector<CellSampler*> group;
        for (const auto& cell : cells_)
            group.push_back(&samplers_.emplace_back(cell, scene_, range_, references_));
        RoundsListener listener;
        listener.progress = [&](std::string_view text, std::optional<double>) {
            if (text.find("round") != text.npos) turns_.emplace_back(text);
        };
        listener.finished = [&](const Outcome& outcome, const Sampling& sampling) {
            outcomes_.push_back(outcome);
            sampling_ = sampling;
        };
        listener.before_round = [&] { turns_at_rounds_.push_back(turns_.size()); };
        listener.stop = [&] { return turns_.size() >= most_turns_; };
        return sample_group(group, check_, criterion, seed, listener);
    }

    std::unique_ptr<Device> other_ = host::make_device();
    Scene scene_ = crowd(5, 6, 1.0);
    FrameRange range_{scene_, 0, 1};
    References references_{scene_, range_};
    std::deque<Cell> cells_;
    std::deque<LocalSampler> samplers_;
    CheckOptions check_;
    std::vector<std::string> turns_;           ///< a line for each turn of a cell
    std::vector<std::size_t> turns_at_rounds_; ///< at the beginning of each round
    std::size_t most_turns_ = 1000000;
    std::vector<Outcome> outcomes_;
    Sampling sampling_;
};

TEST_F(SamplingRounds, RepeatFixesTheNumberOfSamples) {
    EXPECT_FALSE(sample({.repeat = 4}));
    ASSERT_EQ(outcomes_.size(), 3u);
    for (const auto& outcome : outcomes_) {
        const auto& m = outcome.sampler->measurement();
        EXPECT_THAT(m.rounds(), ElementsAre(0, 1, 2, 3));
        EXPECT_EQ(m.breakdowns.size(), 4u);
        for (const auto& sample : m.samples) EXPECT_EQ(sample.frame_ns.size(), 2u);
        EXPECT_EQ(m.agreement.frames, 2u);
        EXPECT_TRUE(m.agreement.ok());
        EXPECT_TRUE(outcome.failure.empty());
    }
    EXPECT_EQ(sampling_.cells, 3u);
    EXPECT_EQ(turns_.size(), 12u);
    EXPECT_THAT(turns_at_rounds_, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
}

TEST_F(SamplingRounds, WithoutSamplesThereAreAnswersAndOneBreakdown) {
    sample({.repeat = 0});
    for (const auto& outcome : outcomes_) {
        EXPECT_TRUE(outcome.sampler->measurement().samples.empty());
        EXPECT_EQ(outcome.sampler->measurement().breakdowns.size(), 1u);
        EXPECT_GT(median_ns(outcome.sampler->measurement()), 0);
    }
}

/// The clocks of a GPU take longer to rise than a few replays of a small scene.
TEST_F(SamplingRounds, WarmUpForFiveMilliseconds) {
    const auto pair = crowd(5, 2, 1.0);
    const FrameRange range(pair, 0, 0);
    References references(pair, range);
    LocalSampler sampler(cells_.front(), pair, range, references);
    sampler.check(check_);
    sampler.round(1);
    EXPECT_GE(sampler.state().spent_ns, 5'000'000);
}

/// Every round contains every cell once, in an order that varies; equal seeds give equal orders.
TEST_F(SamplingRounds, AlternateInARandomOrder) {
    sample({.repeat = 6}, 7);
    const auto first = turns_;
    ASSERT_EQ(first.size(), 18u);
    bool differs = false;
    for (std::size_t round = 1; round < 6; ++round) {
        std::set<std::string> in_round(first.begin() + 3 * static_cast<long>(round),
                                       first.begin() + 3 * static_cast<long>(round) + 3);
        EXPECT_EQ(in_round.size(), 3u);
        const auto cell = [&](std::size_t turn) { return turns_[turn].substr(0, turns_[turn].find(':')); };
        differs |= cell(3 * round) != cell(0);
    }
    EXPECT_TRUE(differs);
    turns_.clear();
    samplers_.clear();
    sample({.repeat = 6}, 7);
    EXPECT_EQ(turns_, first);
}

TEST_F(SamplingRounds, AreAtLeastTenAndAsManyAsTheIntervalNeeds) {
    sample({.noise = 1.0, .seconds = 1e6});
    for (const auto& outcome : outcomes_) {
        EXPECT_GE(outcome.sampler->measurement().round_count(), StoppingCriterion::least);
        EXPECT_TRUE(outcome.converged);
    }
    samplers_.clear();
    outcomes_.clear();
    sample({.noise = 1e-9, .seconds = 1e-3});
    for (const auto& outcome : outcomes_) {
        EXPECT_EQ(outcome.sampler->measurement().round_count(), StoppingCriterion::least);
        EXPECT_FALSE(outcome.converged);
    }
}

TEST_F(SamplingRounds, AFailureAffectsItsOwnCellOnly) {
    other_->set_memory_limit(1024);
    add({{"k", "8"}}, *other_);
    sample({.repeat = 2});
    ASSERT_EQ(outcomes_.size(), 4u);
    std::size_t failed = 0;
    for (const auto& outcome : outcomes_) {
        const bool is_short = &outcome.sampler->cell() == &cells_.back();
        EXPECT_EQ(!outcome.failure.empty(), is_short) << outcome.failure;
        EXPECT_EQ(outcome.sampler->measurement().samples.size(), is_short ? 0u : 2u);
        failed += outcome.failure.empty() ? 0 : 1;
    }
    EXPECT_EQ(failed, 1u);
}

TEST_F(SamplingRounds, StopKeepsFinishedSamples) {
    most_turns_ = 8; // in the third round
    EXPECT_TRUE(sample({.repeat = 50}));
    ASSERT_EQ(outcomes_.size(), 3u);
    std::size_t samples = 0;
    for (const auto& outcome : outcomes_) samples += outcome.sampler->measurement().samples.size();
    EXPECT_EQ(samples, 7u); // the eighth turn stops before its first frame
    EXPECT_TRUE(sampling_.interrupted);
}

/// The stop comes before the first frame of a turn: the first round of a cell.
TEST_F(SamplingRounds, StopInTheFirstRoundOmitsTheCell) {
    most_turns_ = 2;
    EXPECT_TRUE(sample({.repeat = 50}));
    ASSERT_EQ(outcomes_.size(), 1u);
    EXPECT_THAT(outcomes_.front().sampler->measurement().rounds(), ElementsAre(0));
}

/// The stop comes between two frames of a replay, so that a sample may be whole and its round not.
TEST_F(SamplingRounds, AnInterruptedRoundOrCheckLeavesNothing) {
    LocalSampler sampler(cells_.front(), scene_, range_, references_);
    std::size_t calls = 0, most = 1;
    sampler.stop_when([&] { return ++calls > most; });
    EXPECT_THROW(sampler.check(check_), Interrupted);
    EXPECT_FALSE(sampler.state().is_checked());
    EXPECT_TRUE(sampler.measurement().candidate_pairs.empty());
    most = 1000000;
    sampler.check(check_);
    sampler.round(1);
    EXPECT_EQ(sampler.measurement().candidate_pairs.size(), 2u);
    calls = 0;
    sampler.round(2);
    most = calls - 1; // before the last frame of the breakdown
    calls = 0;
    // Warming up takes a number of replays that varies, so that the stop may come at any frame.
    EXPECT_THROW(
        {
            for (int i = 0; i < 100; ++i) sampler.round(2);
        },
        Interrupted);
    const auto& m = sampler.measurement();
    EXPECT_EQ(m.samples.size(), 1 + 2 * (m.breakdowns.size() - 1));
    EXPECT_EQ(m.conditions.size(), m.breakdowns.size());
    EXPECT_EQ(sampler.state().rounds, m.breakdowns.size());
}

/// A round stores its conditions after its samples and before its breakdown.
TEST_F(SamplingRounds, ARoundInterruptedInItsBreakdownLeavesNothing) {
    LocalSampler sampler(cells_.front(), scene_, range_, references_);
    const auto& m = sampler.measurement();
    sampler.stop_when([&] { return m.breakdowns.size() == 1 && m.conditions.size() == 2; });
    sampler.check(check_);
    sampler.round(1);
    EXPECT_THROW(sampler.round(2), Interrupted);
    EXPECT_THAT(m.rounds(), ElementsAre(0));
    EXPECT_EQ(m.conditions.size(), 1u);
    EXPECT_EQ(m.breakdowns.size(), 1u);
    EXPECT_EQ(sampler.state().rounds, 1u);
}

} // namespace
} // namespace tandem
