// SPDX-License-Identifier: MIT
// Partitions of bodies into subdomains: the owner of each pair, when a partition expires, and the work it
// expects.
#include "algorithms/distributed/partitioner.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

TEST(Partitioner, EveryPairBelongsToOneSubdomainWithBothBodies) {
    const auto scene = procession(40, 2, 0.05);
    for (const std::size_t count : {1u, 2u, 3u, 7u, 60u}) {
        Partitioner partitioner(scene, {}, count);
        EXPECT_FALSE(partitioner.is_valid(scene.frame(0)));
        partitioner.partition(scene.frame(0), std::vector<double>(count, 1.0));
        EXPECT_TRUE(partitioner.is_valid(scene.frame(0)));
        std::multiset<std::uint32_t> owned;
        std::vector<std::vector<Role>> roles;
        for (const auto& subdomain : partitioner.subdomains()) {
            owned.insert(subdomain.own.begin(), subdomain.own.end());
            roles.push_back(roles_of(subdomain, scene.bodies.size()));
        }
        EXPECT_EQ(owned.size(), 39u) << "all but the fixed one, each once";
        EXPECT_EQ(std::set<std::uint32_t>(owned.begin(), owned.end()).size(), 39u);
        // Also in a later frame, as long as the partition is valid.
        for (std::size_t i = 0; i < 2; ++i) {
            ASSERT_TRUE(partitioner.is_valid(scene.frame(i)));
            for (const auto& pair : BroadSweep(scene, {}, Broad::tight).pairs(scene.frame(i))) {
                std::size_t owners = 0;
                for (const auto& role : roles)
                    owners += role[pair.a] != Role::none && role[pair.b] != Role::none
                              && (role[pair.a] == Role::own || role[pair.b] == Role::own);
                EXPECT_EQ(owners, 1u) << count << " subdomains, bodies " << pair.a << " and " << pair.b;
            }
        }
    }
}

TEST(Partitioner, ExpiresWhenABodyMovesFurtherThanItsSkin) {
    const auto scene = procession(10, 2, 0);
    Partitioner partitioner(scene, {}, 2);
    partitioner.partition(scene.frame(0), std::array{1.0, 1.0});
    const auto is_valid_with = [&](std::uint32_t body, const auto& change) {
        auto frame = scene.frame(0);
        change(frame, body);
        return partitioner.is_valid(frame);
    };
    const auto push = [](double displacement) {
        return [displacement](Frame& frame, std::uint32_t body) {
            frame.poses[body].translation.x() += displacement;
        };
    };
    EXPECT_TRUE(is_valid_with(5, push(0.1)));
    EXPECT_FALSE(is_valid_with(5, push(0.4)));
    EXPECT_TRUE(is_valid_with(0, push(0.4))) << "a fixed body does not move, whatever its pose in the frame";
    const auto turn = [](Frame& frame, std::uint32_t body) {
        frame.poses[body].rotation =
            Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX())) * frame.poses[body].rotation;
    };
    EXPECT_FALSE(is_valid_with(5, turn));
    const auto stretch = [](Frame& frame, std::uint32_t body) { frame.deformed[body].back().z() += 1; };
    EXPECT_FALSE(is_valid_with(1, stretch));
    const auto invalidate = [](Frame& frame, std::uint32_t body) {
        frame.poses[body].translation.x() = std::numeric_limits<double>::quiet_NaN();
    };
    EXPECT_FALSE(is_valid_with(5, invalidate));
}

/// Work is divided by speed, and after calibration by the pairs found instead of estimates from balls.
TEST(Partitioner, DividesWorkBySpeedAndByPairsFound) {
    const auto scene = procession(100, 1, 0);
    Partitioner partitioner(scene, {}, 2);
    partitioner.partition(scene.frame(0), std::array{1.0, 1.0});
    EXPECT_NEAR(static_cast<double>(partitioner.subdomains()[0].own.size()), 49.5, 3);
    partitioner.partition(scene.frame(0), std::array{3.0, 1.0});
    EXPECT_NEAR(static_cast<double>(partitioner.subdomains()[0].own.size()), 74.25, 3);
    EXPECT_EQ(partitioner.expected_pairs(0), 0u) << "balls alone give no estimate of pairs";
    std::vector<std::uint64_t> counts(100, 1000);
    std::fill(counts.begin(), counts.begin() + 50, 100'000);
    partitioner.calibrate(counts);
    partitioner.partition(scene.frame(0), std::array{1.0, 1.0});
    const auto& owned = partitioner.subdomains()[0].own;
    const auto first = std::ranges::find(owned, 2u) != owned.end() ? owned.size() : 99 - owned.size();
    EXPECT_LT(first, 30u) << "the first fifty bodies have almost all of the work";
    const auto expected = static_cast<double>(partitioner.expected_pairs(0) + partitioner.expected_pairs(1));
    const auto sum = static_cast<double>(std::accumulate(counts.begin(), counts.end(), 0ull));
    EXPECT_NEAR(expected / (sum / 2), 1, 0.1) << "each pair is counted at two bodies";
}

/// No body pair has candidate pairs: work is the bounding of bodies, own and ghost, so ghost bodies must
/// count.
TEST(Partitioner, CountsTheWorkOfGhostBodies) {
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
    Partitioner partitioner(scene, {}, 4);
    partitioner.partition(frame, std::array{1.0, 1.0, 1.0, 1.0});
    partitioner.calibrate(std::vector<std::uint64_t>(scene.bodies.size()));
    partitioner.partition(frame, std::array{1.0, 1.0, 1.0, 1.0});
    std::size_t most = 0, sum = 0;
    for (const auto& subdomain : partitioner.subdomains()) {
        most = std::max(most, subdomain.own.size() + subdomain.ghosts.size());
        sum += subdomain.own.size() + subdomain.ghosts.size();
    }
    EXPECT_GT(sum, scene.bodies.size() * 11 / 10);
    EXPECT_LT(static_cast<double>(most), 1.04 * static_cast<double>(sum) / 4);
}

} // namespace
} // namespace tandem
