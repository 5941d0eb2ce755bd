// SPDX-License-Identifier: MIT
#include "harness/choosing/race.h"

#include "base/random.h"
#include "tests/nvrtc/compiling_device.h"
#include "tests/support/cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace tandem {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t ms = 1000000;

/// A race of candidates with given times; nothing is run.
struct Bench {
    std::vector<std::int64_t> times;                    ///< ns per replay of each candidate
    std::function<double()> noise = [] { return 1.0; }; ///< factor on the time of a replay
    std::set<std::size_t> failing{}, other{};           ///< that fail, and that find other pairs
    std::vector<std::size_t> order{};                   ///< the candidate of every replay
    Device* device = &support::device("host");
    std::set<std::size_t> prepared{};
    std::size_t most_prepared = 0; ///< at once
    std::vector<Cell> cells{times.size(),
                            make_cell(*algorithms()[0], algorithms()[0]->presets()[0], {}, {device})};
    Race race{cells,
              {.prepare =
                   [this](std::size_t i) {
                       if (failing.contains(i)) throw DeviceError("lost");
                       prepared.insert(i);
                       most_prepared = std::max(most_prepared, prepared.size());
                   },
               .replay = [this](std::size_t i) -> Replayed {
                   EXPECT_TRUE(prepared.contains(i));
                   order.push_back(i);
                   const auto ns = static_cast<double>(times[i]) * noise();
                   return {static_cast<std::int64_t>(ns), other.contains(i) ? 8u : 7u, 0};
               },
               .free = [this](std::size_t i) { prepared.erase(i); }}};
};

TEST(ChoosingRace, RanksAllAndDropsSlowOnesAfterOneReplay) {
    Bench close{{5 * ms, 3 * ms, 4 * ms, 2 * ms, 6 * ms}};
    EXPECT_EQ(close.race.pairs(), 7u);
    EXPECT_THAT(close.race.run(10), ElementsAre(3, 1, 2, 0, 4));
    EXPECT_THAT(close.prepared, ElementsAre(3));
    Bench far{{50 * ms, 10 * ms, 39 * ms, 41 * ms}};
    EXPECT_EQ(far.race.run(10).front(), 1u);
    EXPECT_EQ(far.race.times(0).size(), 1u); // when the second had been measured
    EXPECT_EQ(far.race.times(3).size(), 1u);
    EXPECT_GT(far.race.times(2).size(), 1u);
    EXPECT_LT(far.order.size(), 40u); // ends when the best is clear
}

/// Single replays mislead in most of these races; the best is 10 % faster than the next of 14.
TEST(ChoosingRace, FindsTheBestUnderNoise) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Random random(seed);
        std::vector<std::int64_t> times;
        for (int i = 0; i < 14; ++i) times.push_back(11 * ms + i * ms / 4);
        times[seed % 14] = 10 * ms;
        Bench bench{times, [&] {
                        return random.next() % 10 == 0 ? 2.0
                                                       : 1 + static_cast<double>(random.next() % 100) * 2e-3;
                    }};
        const auto ranking = bench.race.run(10);
        EXPECT_EQ(ranking.front(), seed % 14) << seed;
        ASSERT_EQ(ranking.size(), 14u);
    }
}

/// The times of all overlap, so only repeated rounds separate them.
TEST(ChoosingRace, SpendsItsTimeOnCloseCandidates) {
    Random random(3);
    Bench bench{{10 * ms, 11 * ms, 12 * ms, 13 * ms, 14 * ms, 15 * ms, 16 * ms, 17 * ms},
                [&] { return random.next() % 3 == 0 ? 2.0 : 1.0; }};
    const auto ranking = bench.race.run(10);
    EXPECT_EQ(ranking.front(), 0u);
    EXPECT_GT(bench.race.times(ranking[0]).size(), 2 * bench.race.times(ranking[7]).size());
}

/// Each is prepared with one replay, and then tried; sweeps alternate.
TEST(ChoosingRace, InterleavesTheReplaysOfARound) {
    Bench bench{{10 * ms, 11 * ms, 12 * ms}};
    bench.race.run(10);
    EXPECT_THAT(std::vector(bench.order.begin(), bench.order.begin() + 12),
                ElementsAre(0, 0, 1, 1, 2, 2, 0, 1, 2, 2, 1, 0));
}

/// 100 candidates of 1 s: the ten seconds are over before all were tried.
TEST(ChoosingRace, RespectsItsTimeLimit) {
    Bench slow{std::vector<std::int64_t>(100, 1000 * ms)};
    EXPECT_EQ(slow.race.run(10).size(), 5u); // half of the time is for first trials
    EXPECT_LE(slow.race.measured(), 11);
    EXPECT_THAT(slow.race.times(5), IsEmpty());
    Bench hurried{{5 * ms, 3 * ms}};
    EXPECT_THAT(hurried.race.run(0), ElementsAre(0)); // at least one in any case
}

/// The second and later candidates are hopeless, so that each is freed after its trial.
TEST(ChoosingRace, PreparesAsManyTogetherAsTheDeviceCompilesAtOnce) {
    const std::vector<std::int64_t> times{1 * ms, 9 * ms, 9 * ms, 9 * ms, 9 * ms};
    Bench one{times};
    EXPECT_THAT(one.race.run(10), ElementsAre(0, 4, 3, 2, 1));
    EXPECT_EQ(one.most_prepared, 2u);
    CompilingDevice device(3);
    Bench three{times, [] { return 1.0; }, {}, {}, {}, &device};
    EXPECT_THAT(three.race.run(10), ElementsAre(0, 4, 3, 2, 1));
    EXPECT_EQ(three.most_prepared, 3u);
    EXPECT_THAT(three.prepared, ElementsAre(0));
    Bench lost{times, [] { return 1.0; }, {1}, {}, {}, &device};
    EXPECT_THAT(lost.race.run(10), ElementsAre(0, 4, 3, 2));
    EXPECT_EQ(lost.race.failure(1), "lost");
}

TEST(ChoosingRace, ContinuesWithoutFailingCandidates) {
    Bench some{{1 * ms, 2 * ms, 3 * ms, 4 * ms}, [] { return 1.0; }, {0}, {2}};
    EXPECT_THAT(some.race.run(10), ElementsAre(1, 3));
    EXPECT_EQ(some.race.failure(0), "lost");
    EXPECT_EQ(some.race.failure(2), "found 8 candidate pairs, the first candidate 7");
    Bench all{{1, 2}, [] { return 1.0; }, {0, 1}};
    EXPECT_THAT(all.race.run(10), IsEmpty());
    EXPECT_EQ(all.race.pairs(), 0u);
}

} // namespace
} // namespace tandem
