// SPDX-License-Identifier: MIT
// The two placements of vertices. Rounded transforms displace vertices by at most drift_bound. Slabs widened
// by it (placement=exact) keep every pair that touches or overlaps at the exact poses.
#include "algorithms/bodies/drift.h"
#include "algorithms/bodies/pack.h"
#include "harness/verify/oracle/drift.h"
#include "harness/verify/oracle/frame_truth.h"
#include "harness/verify/oracle/posed.h"
#include "tests/support/cells.h"
#include "tests/support/leaf_slabs.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using oracle::posed_corners;
using oracle::posed_point;

Geometry posed_geometry(int k, Rounding rounding, Precision precision) {
    return {.k = k, .precision = precision, .rounding = rounding, .placement = Placement::exact};
}

TEST(Posed, RotationsUseTheNormalisedQuaternion) {
    Pose pose;
    pose.rotation = Eigen::Quaterniond(3, 0, 0, 4); // not of unit length: more than half a turn about z
    pose.translation = {0.5, -2, 1e300};
    const auto p = posed_point(pose, {1, 2, 3});
    // R = {{-7, -24, 0}, {24, -7, 0}, {0, 0, 25}} / 25
    EXPECT_EQ(p[0], mpq_class(-17, 10));
    EXPECT_EQ(p[1], mpq_class(-8, 5));
    EXPECT_EQ(p[2], mpq_class(1e300) + 3);
}

TEST(Posed, RelationsEqualTheOracleUnderAnyPose) {
    Random random(8);
    TouchMaker maker(8);
    std::array<int, 3> seen{};
    for (int i = 0; i < 60; ++i) {
        auto pair = maker.touching(1 + i % 3, 1 + i / 3 % 3, 8);
        if (i % 3 != 0)
            for (auto& corner : pair.b) corner[i % 2] += i % 5 - 2;
        if (i % 7 == 0) pair.a[3] = pair.a[2];
        const Pose pose{random.rotation(), random.direction() * 1e3};
        const auto expected = relation(pair.a, pair.b);
        EXPECT_EQ(oracle::relation(posed_corners(pose, pair.a), posed_corners(pose, pair.b)), expected);
        ++seen[static_cast<unsigned>(expected)];
    }
    EXPECT_THAT(seen, testing::Each(testing::Gt(2)));
}

/// Two bodies rotated about a slab direction, which the rotation preserves, and shifted along it: contact
/// planes of the meshes remain exactly perpendicular to it.
struct TurnedPairs {
    std::vector<OraclePair> pairs; ///< in mesh coordinates
    std::array<Pose, 2> poses;
};

TurnedPairs turned_pairs(Random& random, double offset, std::size_t count) {
    const auto along = directions({.k = 26});
    const auto d = along[random.next() % along.size()];
    TurnedPairs result;
    SlabTouchMaker<float> maker(random.next(), 0);
    const double shift = std::ldexp(std::floor(random.uniform(-256, 256)), -8);
    const Eigen::Vector3d direction(d[0], d[1], d[2]);
    const Eigen::Vector3d turn = random.uniform(-2, 2) * direction;
    Pose pose;
    pose.rotation = Eigen::Quaterniond(random.uniform(0.1, 1), turn.x(), turn.y(), turn.z());
    // a length that double represents together with the shift, but float does not
    for (auto& t : pose.translation)
        t = std::ldexp(std::floor(std::ldexp(offset * random.uniform(-1, 1), 20)), -20);
    result.poses = {pose, pose};
    result.poses[1].translation += shift * direction;
    for (std::size_t i = 0; i < count; ++i) {
        auto pair = maker.touching(d, {0, 0, 0});
        for (auto& corner : pair.b)
            for (unsigned axis = 0; axis < 3; ++axis) corner[axis] -= shift * d[axis];
        result.pairs.push_back(std::move(pair));
    }
    return result;
}

/// Number of touching pairs of a batch that some axis separates.
template<class Real>
std::uint64_t missed(const TurnedPairs& turned, const Geometry& geometry) {
    const PairScene scene(turned.pairs, turned.poses);
    const LeafSlabs<Real> slabs(device("host"), scene, geometry);
    std::uint64_t result = 0;
    for (std::size_t i = 0; i < turned.pairs.size(); ++i) result += slabs.separated(i) ? 1 : 0;
    return result;
}

TEST(Truth, ExactPlacementKeepsPairsThatTouchAtTheirPoses) {
    const char* given = std::getenv("TANDEM_DRAWS");
    constexpr std::size_t batch = 100;
    const auto batches = (given == nullptr ? 8000 : std::strtoull(given, nullptr, 10)) / batch;
    Random random(9);
    std::map<std::string, std::uint64_t> lost;
    std::uint64_t checked = 0;
    for (std::uint64_t i = 0; i < batches; ++i) {
        const auto turned = turned_pairs(random, std::pow(10.0, static_cast<double>(i % 6) - 1), batch);
        for (std::size_t j = 0; j < batch; ++j) {
            const auto& pair = turned.pairs[j];
            ASSERT_EQ(oracle::relation(posed_corners(turned.poses[0], pair.a),
                                       posed_corners(turned.poses[1], pair.b)),
                      Relation::touching);
        }
        checked += batch;
        for (const int k : {8, 18}) {
            for (const auto rounding : {Rounding::safe, Rounding::directed}) {
                lost["exact"] += missed<float>(turned, posed_geometry(k, rounding, Precision::fp32));
                lost["exact double"] += missed<double>(turned, posed_geometry(k, rounding, Precision::fp64));
            }
            lost["rounded"] += missed<float>(turned, {.k = k});
            lost["rounded double"] += missed<double>(turned, {.k = k, .precision = Precision::fp64});
        }
    }
    fmt::print("{} pairs that touch, k = 8 and 18: placement=rounded misses {} in float and {} in double\n",
               checked, lost["rounded"], lost["rounded double"]);
    EXPECT_GT(checked, 1000u);
    EXPECT_EQ(lost["exact"], 0u);
    EXPECT_EQ(lost["exact double"], 0u);
    EXPECT_GT(lost["rounded"], 0u);
    EXPECT_GT(lost["rounded double"], 0u);
}

/// The truth of a frame at its exact poses contains all pairs in any precision; that of rounded vertices does
/// not.
TEST(Truth, OfPosesContainsPairsThatTouchAtTheirPoses) {
    Random random(10);
    std::uint64_t lost = 0, known = 0, exact = 0;
    for (int i = 0; i < 36; ++i) { // along every slab direction, including those of boxes
        const auto turned = turned_pairs(random, std::pow(10.0, i % 6 - 1), 10);
        const PairScene scene(turned.pairs, turned.poses);
        const auto pose_truth =
            frame_truth(scene.scene(), scene.frame(), {Precision::fp32, Placement::exact});
        const auto vertex_truth = frame_truth(scene.scene(), scene.frame(), Precision::fp32);
        for (std::uint32_t j = 0; j < turned.pairs.size(); ++j) {
            const Pair pair{0, j, 1, j};
            known += std::ranges::binary_search(pose_truth.touching, pair);
            lost += !std::ranges::binary_search(vertex_truth.touching, pair)
                    && !std::ranges::binary_search(vertex_truth.overlapping, pair);
        }
        exact += pose_truth.decisions[Tier::big_integers];
    }
    EXPECT_EQ(known, 360u);
    EXPECT_GE(exact, 360u);
    EXPECT_GT(lost, 10u);
}

/// Deformable bodies have no pose; the rounding of their vertices to float counts as drift.
TEST(Truth, ExactPlacementKeepsDeformablePairsThatTouchInDoubleOnly) {
    for (const double offset : {0.0, 10.0, 1e4}) {
        SlabTouchMaker<double> maker(11, offset);
        std::vector<OraclePair> pairs;
        for (std::size_t i = 0; i < 1300; ++i) {
            pairs.push_back(maker.touching(directions({.k = 26})[i % 13], {1, -1, 0.5}));
            ASSERT_EQ(relation(pairs.back().a, pairs.back().b), Relation::touching);
        }
        const PairScene scene(pairs);
        const auto lost_of = [&](const Geometry& geometry) {
            const LeafSlabs<float> slabs(device("host"), scene, geometry);
            std::uint64_t lost = 0;
            for (std::size_t i = 0; i < pairs.size(); ++i) lost += slabs.separated(i) ? 1 : 0;
            return lost;
        };
        // E, which k = 8 adds in any case, happens to be sufficient.
        EXPECT_GT(lost_of({.k = 18}), 0u) << "at " << offset;
        for (const int k : {8, 18}) {
            for (const auto rounding : {Rounding::safe, Rounding::directed})
                EXPECT_EQ(lost_of(posed_geometry(k, rounding, Precision::fp32)), 0u)
                    << "k = " << k << " at " << offset;
        }
    }
}

TEST(Truth, DriftIsWithinItsBoundAndCloseToIt) {
    for (const auto precision : {Precision::fp32, Precision::fp64}) {
        double largest = 0;
        for (const double offset : {0.0, 1.0, 1e3, 1e6}) {
            const auto scene = crowd(71, 30, 1.0);
            auto frame = scene.frame(1);
            Random random(10);
            for (std::size_t body = 0; body < frame.poses.size(); ++body) {
                if (scene.bodies[body].deformable) continue;
                frame.poses[body].translation += offset * random.direction();
                frame.poses[body].rotation.coeffs() *= random.uniform(0.5, 2);
            }
            const auto drift = vertex_drift(scene, frame, precision);
            fmt::print(
                "offset {:>7}, {}: {} vertices, drift median {:.2f} p99 {:.2f} max {:.2f} ulps, {:.2f} of "
                "its bound\n",
                offset, precision == Precision::fp32 ? "float " : "double", drift.vertices, drift.median,
                drift.p99, drift.max, drift.of_bound);
            EXPECT_EQ(drift.vertices, vertex_count(scene));
            EXPECT_LE(drift.of_bound, 1);
            EXPECT_LE(drift.median, drift.p99);
            EXPECT_LE(drift.p99, drift.max);
            EXPECT_GT(drift.max, 0.4);
            largest = std::max(largest, drift.of_bound);
        }
        EXPECT_GT(largest, 0.1) << "the bound is too loose to be tested";
    }
}

/// Meshes are centred; the rounding of the composed translation is a part of the bound (theorem 5).
TEST(Truth, DriftOfCentredMeshesIsWithinItsBoundAndSmall) {
    for (const auto precision : {Precision::fp32, Precision::fp64}) {
        double largest = 0;
        for (const double distance : {1e2, 1e4, 1e6, 1e9}) {
            const auto scene = with_distant_meshes(crowd(71, 30, 1.0), {distance, distance, 3 * distance});
            const auto frame = scene.frame(1);
            const auto centred = vertex_drift(scene, frame, precision, Origin::automatic);
            EXPECT_LE(centred.of_bound, 1) << distance;
            largest = std::max(largest, centred.of_bound);
            if (precision == Precision::fp32 && distance < 1e7) {
                EXPECT_LE(centred.max, 8) << distance;
                EXPECT_GT(vertex_drift(scene, frame, precision).max, distance) << "in ulps, not centred";
            }
        }
        EXPECT_GT(largest, 0.05) << "the bound is too loose to be tested";
    }
}

TEST(Truth, DriftIsZeroWhereNothingIsRounded) {
    const auto scene = crowd(72, 3, 1.0);
    auto frame = scene.frame(0);
    for (auto& pose : frame.poses) pose = {};
    EXPECT_EQ(vertex_drift(scene, frame, Precision::fp64).max, 0);
    // In float the vertices themselves are rounded, by at most half an ulp.
    const auto drift = vertex_drift(scene, frame, Precision::fp32);
    EXPECT_GT(drift.max, 0.2);
    EXPECT_LE(drift.max, 0.5);
}

} // namespace
} // namespace tandem
