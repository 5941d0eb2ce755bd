// SPDX-License-Identifier: MIT
// The reference: the sweep against brute force, and the host's broad phases against both.
#include "algorithms/broad_phase/broad.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

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

/// Two tetrahedra that share one corner, in units of `unit`. At 0.6 and 1.4 along x, both corners round to 1
/// if `unit` is the smallest representable number.
Scene corner_to_corner(double unit, double left, double right) {
    Scene scene;
    for (const auto& [corner, far] : {std::pair{left, -400.0}, {right, 400.0}}) {
        Mesh mesh;
        mesh.vertices = {unit * Eigen::Vector3d(corner, 0, 0), unit * Eigen::Vector3d(far, -1, -1),
                         unit * Eigen::Vector3d(far, 1, -1), unit * Eigen::Vector3d(far, 0, 1)};
        mesh.tetrahedra = {{0, 1, 2, 3}};
        scene.meshes.push_back(std::move(mesh));
        scene.bodies.push_back({.mesh = static_cast<std::uint32_t>(scene.bodies.size())});
    }
    scene.frame = [](std::size_t) { return Frame{{Pose{}, Pose{}}, {}, {}}; };
    return scene;
}

TEST(Broad, KeepsBodiesBelowTheSmallestNormalNumber) {
    // The smallest floats; the smallest doubles; doubles whose squares underflow to zero.
    const auto least_floats = corner_to_corner(0x1p-149, 0.6, 1.4);
    const auto least_doubles = corner_to_corner(0x1p-1074, 1, 1);
    const auto no_squares = corner_to_corner(0x1p-600, 1, 1);
    for (const int k : {6, 8, 18})
        for (const auto rounding : {Rounding::safe, Rounding::published})
            for (const auto bound : {Broad::sphere, Broad::tight}) {
                const auto trace = testing::Message() << "k = " << k << " " << int(rounding) << int(bound);
                const Geometry single{.k = k, .rounding = rounding};
                const Geometry doubled{.k = k, .precision = Precision::fp64, .rounding = rounding};
                for (const auto& [scene, geometry] :
                     {std::pair{&least_floats, single}, {&least_doubles, doubled}, {&no_squares, doubled}}) {
                    const auto frame = scene->frame(0);
                    EXPECT_EQ(reference(*scene, frame, geometry, false, Method::brute_force).pairs.size(), 1u)
                        << trace;
                    EXPECT_EQ(BroadSweep(*scene, geometry, bound).pairs(frame),
                              (std::vector<BodyPair>{{0, 1}}))
                        << trace;
                }
            }
}

} // namespace
} // namespace tandem
