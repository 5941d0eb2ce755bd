// SPDX-License-Identifier: MIT
#include "harness/verify/oracle/frame_truth.h"
#include "harness/verify/reference.h"
#include "harness/verify/world_vertices.h"
#include "base/error.h"
#include "tests/support/message_of.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

/// Every pair of tetrahedra of different bodies that are not both fixed.
std::vector<Pair> all_pairs(const Scene& scene) {
    std::vector<Pair> pairs;
    for (std::uint32_t a = 0; a < scene.bodies.size(); ++a)
        for (std::uint32_t b = a + 1; b < scene.bodies.size(); ++b) {
            if (scene.bodies[a].fixed && scene.bodies[b].fixed) continue;
            for (std::uint32_t i = 0; i < scene.meshes[scene.bodies[a].mesh].tetrahedra.size(); ++i)
                for (std::uint32_t j = 0; j < scene.meshes[scene.bodies[b].mesh].tetrahedra.size(); ++j)
                    pairs.push_back({a, i, b, j});
        }
    return pairs;
}

/// Pairs of that relation, decided one by one; sorted.
std::vector<Pair> brute_force(const Scene& scene, const Frame& frame, Precision precision,
                              Relation relation) {
    const auto pairs = all_pairs(scene);
    const auto decisions = decide_pairs(scene, frame, precision, pairs);
    std::vector<Pair> result;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (decisions[i].relation == relation) result.push_back(pairs[i]);
    std::sort(result.begin(), result.end());
    return result;
}

/// Two boxes of cubes, face to face: corners on a lattice, so they touch exactly.
Scene stacked(double height = 1) {
    Random random(1);
    Scene scene;
    scene.meshes = {shaken_box(2, random)};
    for (auto& vertex : scene.meshes[0].vertices)
        for (auto& x : vertex) x = std::round(2 * x) / 2;
    scene.bodies = {{}, {}};
    scene.frame = [height](std::size_t) {
        Frame frame;
        frame.poses = {{}, {Eigen::Quaterniond::Identity(), {0, 0, height}}};
        frame.deformed.resize(2);
        return frame;
    };
    return scene;
}

TEST(OracleFrame, EqualsBruteForce) {
    const auto scene = crowd(3, 9, 1.2);
    for (const auto precision : {Precision::fp32, Precision::fp64})
        for (std::size_t i = 0; i < scene.frame_count; ++i) {
            const auto frame = scene.frame(i);
            const auto truth = frame_truth(scene, frame, precision);
            EXPECT_TRUE(truth.overlapping == brute_force(scene, frame, precision, Relation::overlapping));
            EXPECT_TRUE(truth.touching == brute_force(scene, frame, precision, Relation::touching));
            EXPECT_GT(truth.overlapping.size(), 100u);
            EXPECT_EQ(truth.overlapping.size(), truth.decisions[Relation::overlapping]);
        }
}

TEST(OracleFrame, FacesOnFaces) {
    const auto scene = stacked();
    const auto frame = scene.frame(0);
    const auto truth = frame_truth(scene, frame, Precision::fp32);
    EXPECT_TRUE(truth.overlapping.empty());
    EXPECT_TRUE(truth.touching == brute_force(scene, frame, Precision::fp32, Relation::touching));
    EXPECT_GT(truth.touching.size(), 20u);
}

/// A gap too small for float.
TEST(OracleFrame, UsesTheVerticesOfTheCell) {
    const auto scene = stacked(1 + 0x1p-40);
    const auto frame = scene.frame(0);
    EXPECT_GT(frame_truth(scene, frame, Precision::fp32).touching.size(), 20u);
    EXPECT_EQ(frame_truth(scene, frame, Precision::fp64).touching.size(), 0u);
}

TEST(OracleFrame, ErrorsOfCandidates) {
    const auto scene = crowd(4, 9, 1.2);
    const auto frame = scene.frame(0);
    const auto truth = frame_truth(scene, frame, Precision::fp32);
    auto candidates = reference(scene, frame, {}, false, Method::brute_force).pairs;
    const auto errors = pair_errors(truth, candidates);
    EXPECT_EQ(errors.candidates, candidates.size());
    EXPECT_EQ(errors.missed_touching + errors.missed_overlapping, 0u) << "k = 18 misses nothing";
    EXPECT_EQ(errors.overlapping, truth.overlapping.size());
    EXPECT_EQ(errors.disjoint + errors.touching + errors.overlapping, errors.candidates);
    EXPECT_GT(errors.disjoint, 0u);
    std::erase(candidates, truth.overlapping[7]);
    EXPECT_EQ(pair_errors(truth, candidates).missed_overlapping, 1u);
    EXPECT_EQ(pair_errors(truth, {}).missed_overlapping, truth.overlapping.size());
}

TEST(OracleFrame, ReportsProgress) {
    const auto scene = crowd(5, 60, 2);
    double last = 0;
    std::uint64_t decided = 0;
    const auto truth =
        frame_truth(scene, scene.frame(0), Precision::fp32, [&](double progress, std::uint64_t done) {
            EXPECT_GE(progress, last);
            EXPECT_LE(progress, 1);
            last = progress;
            decided = done;
        });
    std::uint64_t sum = 0;
    for (const auto count : truth.decisions.relations) sum += count;
    EXPECT_EQ(decided, sum);
    EXPECT_EQ(last, 1);
}

TEST(OracleFrame, NonFiniteCoordinates) {
    const auto scene = crowd(6, 6, 1);
    auto frame = scene.frame(0);
    const auto before = frame_truth(scene, frame, Precision::fp32);
    EXPECT_TRUE(before.invalid.empty());
    frame.deformed[1][0].x() = std::numeric_limits<double>::quiet_NaN();
    const auto truth = frame_truth(scene, frame, Precision::fp32);
    ASSERT_FALSE(truth.invalid.empty());
    for (const auto& [body, tetrahedron] : truth.invalid) {
        const auto& corners = scene.meshes[scene.bodies[body].mesh].tetrahedra[tetrahedron];
        EXPECT_EQ(body, 1u);
        EXPECT_NE(std::find(corners.begin(), corners.end(), 0u), corners.end());
    }
    EXPECT_EQ(truth.decisions[Relation::invalid], 0u);
    const auto errors = pair_errors(truth, std::array{Pair{0, 0, 1, truth.invalid[0][1]}});
    EXPECT_EQ(errors.invalid, 1u);
}

/// g++ 12 drops adjacent roundings to float (see CMakeLists.txt), which would falsify the oracle's input.
TEST(OracleFrame, VerticesSurviveTheRoundTripThroughFloat) {
    const auto scene = make_scene("pile:bodies=8,frames=1");
    const auto frame = scene.frame(0);
    for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
        const auto single = world_vertices<float>(scene, frame, body, Origin::world);
        const auto twice = world_vertices<double>(scene, frame, body, Origin::world);
        bool differ = false;
        for (std::size_t i = 0; i < single.size(); ++i)
            for (unsigned axis = 0; axis < 3; ++axis) {
                const double wide = single[i][axis];
                const volatile auto narrow = static_cast<float>(wide);
                ASSERT_EQ(static_cast<double>(narrow), wide);
                differ |= wide != twice[i][axis];
            }
        EXPECT_TRUE(differ);
    }
}

/// The reported number of bytes is sufficient and one pair less is not; the result does not depend on the
/// limit.
TEST(OracleFrame, RefusesWhatIsTooLargeForMemory) {
    const auto scene = crowd(3, 9, 1.2);
    const auto frame = scene.frame(0);
    const auto expected = frame_truth(scene, frame, Precision::fp32);
    ASSERT_GT(expected.overlapping.size(), 20u);
    const auto near = std::accumulate(expected.decisions.relations.begin(),
                                      expected.decisions.relations.end(), std::uint64_t{0});
    const auto needed = tetrahedron_count(scene) * (4 * 3 + 6) * sizeof(double) + near * 3 * sizeof(Pair);
    const auto sufficient = frame_truth(scene, frame, Precision::fp32, {}, needed);
    EXPECT_EQ(sufficient.overlapping, expected.overlapping);
    EXPECT_EQ(sufficient.touching, expected.touching);
    for (const std::uint64_t memory : {needed - 1, needed / 2, std::uint64_t{1000}, std::uint64_t{0}})
        EXPECT_THAT(support::message_of([&] { frame_truth(scene, frame, Precision::fp32, {}, memory); }),
                    testing::HasSubstr("--truth none, fewer frames"));
}

} // namespace
} // namespace tandem
