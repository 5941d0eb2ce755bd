// SPDX-License-Identifier: MIT
// What the others are compared with: the sweep against brute force, and the host's broad phases against both.
#include "algorithms/broad/broad.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"

#include <gtest/gtest.h>

namespace tandem {
namespace {

using namespace testing_support;

TEST(Reference, SweepEqualsBruteForce) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto scene = crowd(seed, 8, 0.7);
        for (const auto& geometry :
             {Geometry{}, Geometry{.k = 8}, Geometry{.k = 26, .precision = Precision::fp64}}) {
            const auto brute = reference(scene, scene.frame(0), geometry, true, Method::brute_force);
            const auto swept = reference(scene, scene.frame(0), geometry, true, Method::sweep);
            EXPECT_FALSE(brute.pairs.empty());
            EXPECT_EQ(brute.pairs, swept.pairs);
            EXPECT_EQ(brute.contact_digest, swept.contact_digest);
        }
    }
}

TEST(Reference, DifferenceCountsBothWays) {
    const std::vector<Pair> expected{{0, 1, 1, 1}, {0, 2, 1, 1}, {0, 3, 1, 1}};
    const std::vector<Pair> found{{0, 1, 1, 1}, {0, 1, 1, 1}, {0, 4, 1, 1}};
    const auto result = difference(expected, found);
    EXPECT_EQ(result.missing, 2u);
    EXPECT_EQ(result.extra, 2u);
    EXPECT_NE(digest_of(expected), digest_of(found));
}

TEST(Broad, NeverDropsAPairWithCandidates) {
    std::uint64_t pairs = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const auto scene = crowd(1000 + seed, 9, 2.0);
        for (const auto& geometry :
             {Geometry{.k = 8}, Geometry{.k = 6}, Geometry{.k = 18, .precision = Precision::fp64}}) {
            const auto answer = reference(scene, scene.frame(1), geometry, false, Method::brute_force);
            for (const auto bound : {Broad::sphere, Broad::tight}) {
                const auto found = BroadSweep(scene, geometry, bound).pairs(scene.frame(1));
                EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
                for (const auto& p : answer.pairs)
                    ASSERT_TRUE(std::binary_search(found.begin(), found.end(), BodyPair{p.body_a, p.body_b}));
                pairs += answer.pairs.size();
            }
        }
    }
    EXPECT_GT(pairs, 1000u);
}

} // namespace
} // namespace tandem
