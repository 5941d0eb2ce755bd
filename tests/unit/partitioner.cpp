// SPDX-License-Identifier: MIT
// Deals of bodies to shares: who has which pair, when they end, and what work they expect.
#include "algorithms/distributed/partitioner.h"
#include "tests/support/scenes.h"

#include <gtest/gtest.h>
#include <limits>
#include <numeric>
#include <set>

namespace tandem {
namespace {

using namespace testing_support;

TEST(Deals, EveryPairBelongsToOneShareThatHasBoth) {
    const auto scene = procession(40, 2, 0.05);
    for (const std::size_t count : {1u, 2u, 3u, 7u, 60u}) {
        Partitioner deal(scene, {}, count);
        EXPECT_FALSE(deal.is_valid(scene.frame(0)));
        deal.partition(scene.frame(0), std::vector<double>(count, 1.0));
        EXPECT_TRUE(deal.is_valid(scene.frame(0)));
        std::multiset<std::uint32_t> owned;
        std::vector<std::vector<Role>> roles;
        for (const auto& share : deal.subdomains()) {
            owned.insert(share.own.begin(), share.own.end());
            roles.push_back(roles_of(share, scene.bodies.size()));
        }
        EXPECT_EQ(owned.size(), 39u) << "all but the fixed one, each once";
        EXPECT_EQ(std::set<std::uint32_t>(owned.begin(), owned.end()).size(), 39u);
        // Also of a later frame, as long as the deal holds.
        for (std::size_t i = 0; i < 2; ++i) {
            ASSERT_TRUE(deal.is_valid(scene.frame(i)));
            for (const auto& pair : BroadSweep(scene, {}, Broad::tight).pairs(scene.frame(i))) {
                std::size_t having = 0;
                for (const auto& of : roles)
                    having += of[pair.a] != Role::none && of[pair.b] != Role::none
                              && (of[pair.a] == Role::own || of[pair.b] == Role::own);
                EXPECT_EQ(having, 1u) << count << " shares, bodies " << pair.a << " and " << pair.b;
            }
        }
    }
}

TEST(Deals, EndWhenABodyGoesTooFar) {
    const auto scene = procession(10, 2, 0);
    Partitioner deal(scene, {}, 2);
    deal.partition(scene.frame(0), std::array{1.0, 1.0});
    const auto holds_with = [&](std::uint32_t body, const auto& change) {
        auto frame = scene.frame(0);
        change(frame, body);
        return deal.is_valid(frame);
    };
    const auto push = [](double way) {
        return [way](Frame& frame, std::uint32_t body) { frame.poses[body].translation.x() += way; };
    };
    EXPECT_TRUE(holds_with(5, push(0.1)));
    EXPECT_FALSE(holds_with(5, push(0.4)));
    EXPECT_TRUE(holds_with(0, push(0.4))) << "a fixed one does not move, whatever a frame says";
    const auto turn = [](Frame& frame, std::uint32_t body) {
        frame.poses[body].rotation =
            Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX())) * frame.poses[body].rotation;
    };
    EXPECT_FALSE(holds_with(5, turn));
    const auto stretch = [](Frame& frame, std::uint32_t body) { frame.deformed[body].back().z() += 1; };
    EXPECT_FALSE(holds_with(1, stretch));
    const auto lose = [](Frame& frame, std::uint32_t body) {
        frame.poses[body].translation.x() = std::numeric_limits<double>::quiet_NaN();
    };
    EXPECT_FALSE(holds_with(5, lose));
}

/// Work goes by speed, and by what was found where balls told wrong.
TEST(Deals, GoBySpeedAndByWhatWasFound) {
    const auto scene = procession(100, 1, 0);
    Partitioner deal(scene, {}, 2);
    deal.partition(scene.frame(0), std::array{1.0, 1.0});
    EXPECT_NEAR(static_cast<double>(deal.subdomains()[0].own.size()), 49.5, 3);
    deal.partition(scene.frame(0), std::array{3.0, 1.0});
    EXPECT_NEAR(static_cast<double>(deal.subdomains()[0].own.size()), 74.25, 3);
    EXPECT_EQ(deal.expected_pairs(0), 0u) << "balls alone say little of how many";
    std::vector<std::uint64_t> counts(100, 1000);
    std::fill(counts.begin(), counts.begin() + 50, 100'000);
    deal.calibrate(counts);
    deal.partition(scene.frame(0), std::array{1.0, 1.0});
    const auto& owned = deal.subdomains()[0].own;
    const auto first = std::ranges::find(owned, 2u) != owned.end() ? owned.size() : 99 - owned.size();
    EXPECT_LT(first, 30u) << "half of the work is of the first fifty bodies";
    const auto expected = static_cast<double>(deal.expected_pairs(0) + deal.expected_pairs(1));
    const auto sum = static_cast<double>(std::accumulate(counts.begin(), counts.end(), 0ull));
    EXPECT_NEAR(expected / (sum / 2), 1, 0.1) << "each pair is counted at two bodies";
}

/// Bodies in whose pairs nothing is found: the first shares have to bound others' bodies as well as their
/// own.
TEST(Deals, CountWhatOthersBring) {
    Random random(3);
    Scene scene;
    scene.meshes = {shaken_box(1, random)};
    constexpr std::uint32_t side = 8;
    scene.bodies.resize(std::size_t{side} * side * side);
    const double apart = 1.6 * ball_around(scene.meshes[0].vertices).radius;
    Frame frame;
    for (std::uint32_t i = 0; i < side * side * side; ++i)
        frame.poses.push_back(
            {.translation = apart * Eigen::Vector3d(i % side, i / side % side, i / side / side)});
    frame.deformed.resize(scene.bodies.size());
    Partitioner deal(scene, {}, 4);
    deal.partition(frame, std::array{1.0, 1.0, 1.0, 1.0});
    deal.calibrate(std::vector<std::uint64_t>(scene.bodies.size()));
    deal.partition(frame, std::array{1.0, 1.0, 1.0, 1.0});
    std::size_t most = 0, sum = 0;
    for (const auto& share : deal.subdomains()) {
        most = std::max(most, share.own.size() + share.ghosts.size());
        sum += share.own.size() + share.ghosts.size();
    }
    EXPECT_GT(sum, scene.bodies.size() * 11 / 10);
    EXPECT_LT(static_cast<double>(most), 1.04 * static_cast<double>(sum) / 4);
}

} // namespace
} // namespace tandem
