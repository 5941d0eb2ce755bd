// SPDX-License-Identifier: MIT
// The truth at exact poses. A certificate for corners with a tolerance holds for all corners within it. With
// rationals for the rest, every pair gets the decision of rationals alone.
#include "geometry/filter.h"
#include "harness/verify/oracle/frame_truth.h"
#include "geometry/lattice.h"
#include "harness/verify/oracle/posed.h"
#include "harness/verify/oracle/superset.h"
#include "base/parallel.h"
#include "tests/support/oracle_pairs.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using oracle::Posed;
using oracle::posed_corners;

TetraCorners shaken(TetraCorners corners, double off, Random& random) {
    for (auto& corner : corners)
        for (auto& x : corner)
            x += off * (random.next() % 2 == 0 ? -0.999 : 0.999) * (random.next() % 8 != 0);
    return corners;
}

class OracleSlack : public testing::TestWithParam<Family> {};

TEST_P(OracleSlack, CertificatesHoldForAllCornersWithinTheTolerance) {
    Random random(17);
    unsigned disjoint = 0, overlapping = 0, facets = 0, undecided = 0;
    for (unsigned i = 0; i < 3000; ++i) {
        const auto [a, b] = random_pair(GetParam(), random);
        const double off = std::pow(10.0, -1.0 - i % 15);
        const auto filtered = oracle::filter(a, b, off);
        for (int turn = 0; turn < 2; ++turn) {
            const auto p = shaken(a, off, random), q = shaken(b, off, random);
            const auto lattice = oracle::big_lattice(p, q);
            const bool solid_a = oracle::orientation(lattice.a) != 0,
                       solid_b = oracle::orientation(lattice.b) != 0;
            ASSERT_LE(filtered.volume[0], solid_a) << off;
            ASSERT_LE(filtered.volume[1], solid_b) << off;
            if (filtered.disjoint) {
                ++disjoint;
                ASSERT_EQ(relation(p, q), Relation::disjoint) << off;
                continue;
            }
            undecided += filtered.unsure != 0;
            if (filtered.unsure == 0 && filtered.volume[0] && filtered.volume[1]) {
                ++overlapping;
                ASSERT_EQ(relation(p, q), Relation::overlapping) << off;
            }
            if (!solid_a || !solid_b) continue;
            oracle::for_each_facet(lattice.a, lattice.b, oracle::all_facets & ~filtered.unsure,
                                   [&](const auto& facet) {
                                       ++facets;
                                       EXPECT_LT(facet.gap, 0) << off;
                                       return true;
                                   });
        }
    }
    EXPECT_GT(disjoint, 100u);
    EXPECT_GT(overlapping, 100u);
    EXPECT_GT(facets, 1000u);
    EXPECT_GT(undecided, 100u);
}

INSTANTIATE_TEST_SUITE_P(Families, OracleSlack,
                         testing::Values(Family::generic, Family::far_origin, Family::sliver,
                                         Family::scale_ratio, Family::near_touch),
                         [](const auto& instance) {
                             std::string text = name(instance.param);
                             std::replace(text.begin(), text.end(), ' ', '_');
                             return text;
                         });

/// A body of one tetrahedron at its pose, with the rounding errors of the transform as its tolerance.
Posed posed(const TetraCorners& own, const Pose& pose) {
    Posed result{{}, 0, own, &pose};
    for (unsigned i = 0; i < 4; ++i) {
        const Eigen::Vector3d at =
            pose.rotation.normalized() * Eigen::Vector3d(own[i][0], own[i][1], own[i][2]) + pose.translation;
        result.near[i] = {at.x(), at.y(), at.z()};
    }
    result.off = 1e-13 * (4 + pose.translation.norm());
    return result;
}

TEST(OraclePosed, DecisionsEqualRationals) {
    Random random(18);
    TouchMaker maker(18);
    DecisionCounts counts;
    for (int i = 0; i < 1500; ++i) {
        auto pair =
            i % 3 == 0 ? changed(maker.touching(1 + i % 2, 1 + i / 3 % 3, 8), [](double x) { return x / 64; })
            : i % 3 == 1 ? random_pair(Family::near_touch, random)
                         : random_pair(Family::generic, random);
        if (i % 30 == 0) pair.a[3] = pair.a[2];
        Pose both{random.rotation(), random.direction() * std::pow(10.0, i % 5)};
        both.rotation.coeffs() *= random.uniform(0.1, 10);
        const auto found = decide(posed(pair.a, both), posed(pair.b, both));
        ASSERT_EQ(found.relation, oracle::relation(posed_corners(both, pair.a), posed_corners(both, pair.b)));
        ASSERT_EQ(found.relation, relation(pair.a, pair.b)) << "one pose for both changes nothing";
        counts.add(found);
    }
    for (const auto known : {Relation::disjoint, Relation::touching, Relation::overlapping})
        EXPECT_GT(counts[known], 100u);
    EXPECT_GT(counts[Tier::filter], 500u);
    EXPECT_GT(counts[Tier::big_integers], 400u);
    EXPECT_GT(counts[Tier::program], 10u);
}

/// A body of one tetrahedron that touches another with the frame's vertices, and overlaps it at rest.
TEST(OraclePosed, DeformableBodiesUseTheVerticesOfTheFrame) {
    Scene scene;
    scene.meshes.resize(1);
    for (const auto& c : unit) scene.meshes[0].vertices.emplace_back(c[0], c[1], c[2]);
    scene.meshes[0].tetrahedra = {{0, 1, 2, 3}};
    scene.bodies = {{}, {.mesh = 0, .fixed = false, .deformable = true}};
    Frame frame;
    frame.poses.resize(2);
    frame.deformed.resize(2);
    for (const auto& v : scene.meshes[0].vertices) frame.deformed[1].push_back(v + Eigen::Vector3d(1, 0, 0));
    const auto truth = frame_truth(scene, frame, {Precision::fp32, Placement::exact});
    EXPECT_EQ(truth.touching.size(), 1u);
    EXPECT_TRUE(truth.overlapping.empty());
}

TEST(OraclePosed, BoxesAreWidenedByTheTolerance) {
    const std::vector<TetraCorners> a{unit}, b{moved(unit, 1 + 0x1p-10, 0, 0)};
    const std::span<const std::uint32_t> none;
    const auto near = [&](double off) {
        unsigned found = 0;
        oracle::for_near_pairs(oracle::Boxes(a, none, off), oracle::Boxes(b, none, off),
                               [&](auto, auto) { ++found; });
        return found;
    };
    EXPECT_EQ(near(0), 0u);
    EXPECT_EQ(near(0x1p-12), 0u);
    EXPECT_EQ(near(0x1p-11), 1u);
    const oracle::Boxes box(b, none, 0x1p-80); // less than the distance to the next double
    EXPECT_LT(box.tetrahedra[0][0], 1 + 0x1p-10);
    EXPECT_LT(box.whole[0], 1 + 0x1p-10);
    EXPECT_GT(box.whole[3], 2 + 0x1p-10);
}

TEST(OraclePosed, NonFiniteCornersAreInvalid) {
    const Pose pose;
    auto a = posed(unit, pose);
    const auto b = a;
    a.near[1][2] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(decide(a, b).relation, Relation::invalid);
    EXPECT_EQ(decide(b, a).relation, Relation::invalid);
}

/// The scene's vertices transformed by the exact pose; for body 1, those of the frame.
oracle::Points<mpq_class> exact_corners(const Scene& scene, const Frame& frame, std::uint32_t body,
                                        std::uint32_t tetrahedron) {
    const auto& mesh = scene.meshes[scene.bodies[body].mesh];
    oracle::Points<mpq_class> result;
    for (unsigned i = 0; i < 4; ++i) {
        const auto vertex = mesh.tetrahedra[tetrahedron][i];
        const auto& v = scene.bodies[body].deformable ? frame.deformed[body][vertex] : mesh.vertices[vertex];
        result[i] = scene.bodies[body].deformable
                        ? oracle::Vector<mpq_class>{mpq_class(v.x()), mpq_class(v.y()), mpq_class(v.z())}
                        : oracle::posed_point(frame.poses[body], {v.x(), v.y(), v.z()});
    }
    return result;
}

TEST(OraclePosed, FramesEqualRationals) {
    const auto scene = crowd(3, 5, 0.7);
    const auto frame = scene.frame(1);
    const auto truth = frame_truth(scene, frame, {Precision::fp32, Placement::exact});
    EXPECT_TRUE(truth.touching.empty());
    std::uint64_t pairs = 0;
    for (std::uint32_t a = 1; a < 3; ++a) { // 48 deformed tetrahedra and a single one against all others
        std::vector<std::pair<Pair, Relation>> found;
        for (std::uint32_t b = a + 1; b < scene.bodies.size(); ++b)
            for (std::uint32_t i = 0; i < scene.meshes[scene.bodies[a].mesh].tetrahedra.size(); ++i)
                for (std::uint32_t j = 0; j < scene.meshes[scene.bodies[b].mesh].tetrahedra.size(); ++j)
                    found.push_back({{a, i, b, j}, {}});
        parallel_for(found.size(), [&](std::size_t i) {
            const auto& pair = found[i].first;
            found[i].second = oracle::relation(exact_corners(scene, frame, pair.body_a, pair.tet_a),
                                               exact_corners(scene, frame, pair.body_b, pair.tet_b));
        });
        for (const auto& [pair, relation] : found) {
            const bool listed = std::ranges::binary_search(truth.overlapping, pair);
            ASSERT_EQ(relation, listed ? Relation::overlapping : Relation::disjoint);
            pairs += listed;
        }
    }
    EXPECT_GT(pairs, 100u);
}

} // namespace
} // namespace tandem
