// SPDX-License-Identifier: MIT
// Whole scenes between two frames: rotations, and pairs of all bodies against one by one.
#include "harness/verify/oracle/motion_truth.h"
#include "harness/verify/oracle/turn.h"
#include "harness/verify/oracle/world.h"
#include "base/error.h"
#include "tests/support/moving_pairs.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

constexpr double half_turn = 3.141592653589793;

Pose pose_of(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation = {0, 0, 0}) {
    return {rotation, translation};
}

Eigen::Quaterniond about_z(double angle) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
}

/// One mesh of a tetrahedron with these corners.
Mesh one_tetrahedron(const TetraCorners& corners) {
    Mesh mesh;
    for (const auto& c : corners) mesh.vertices.emplace_back(c[0], c[1], c[2]);
    mesh.tetrahedra = {{0, 1, 2, 3}};
    complete_mesh(mesh, "one tetrahedron");
    return mesh;
}

/// Two rigid bodies of one tetrahedron each, and their poses in two frames.
struct TurningPair {
    TetraCorners a, b;
    std::array<Pose, 2> from, to;

    MotionTruth truth(Precision precision = Precision::fp64) const {
        Scene scene;
        scene.meshes = {one_tetrahedron(a), one_tetrahedron(b)};
        scene.bodies = {{.mesh = 0}, {.mesh = 1}};
        const auto frame = [](const std::array<Pose, 2>& poses) {
            return Frame{{poses[0], poses[1]}, std::vector<std::vector<Eigen::Vector3d>>(2)};
        };
        return motion_truth(scene, frame(from), frame(to), precision);
    }
    Meeting meeting() const {
        const auto found = truth();
        EXPECT_LE(found.colliding.size() + found.undecided.size(), 1u);
        if (!found.colliding.empty()) return Meeting::meeting;
        return found.undecided.empty() ? Meeting::apart : Meeting::undecided;
    }
    /// Whether they overlap at one of some times, by the rotation of Eigen's slerp instead of arcs.
    bool overlap_at_a_step(int steps) const {
        for (int step = 0; step <= steps; ++step) {
            const double s = 1.0 * step / steps;
            TetraCorners placed[2];
            for (unsigned body = 0; body < 2; ++body) {
                const auto q = from[body].rotation.slerp(s, to[body].rotation);
                for (unsigned i = 0; i < 4; ++i) {
                    const auto& c = (body == 0 ? a : b)[i];
                    const Eigen::Vector3d x = q * Eigen::Vector3d(c[0], c[1], c[2])
                                              + (1 - s) * from[body].translation + s * to[body].translation;
                    placed[body][i] = {x.x(), x.y(), x.z()};
                }
            }
            if (relation(placed[0], placed[1]) == Relation::overlapping) return true;
        }
        return false;
    }
};

/// A bar along x from -8 to 8, and a small tetrahedron at (0, y, 0). Half a turn about z brings the bar onto
/// itself.
TurningPair half_turned_bar(double y) {
    const TetraCorners bar{{{-8, 0, 0.25}, {-8, 0.25, -0.25}, {8, 0, 0.25}, {8, -0.25, -0.25}}};
    const auto small = moved(changed(OraclePair{unit, unit}, [](double x) { return x / 4; }).a, 0, y, -0.125);
    return {bar, small, {}, {pose_of(Eigen::Quaterniond(0, 0, 0, 1)), {}}};
}

TEST(OracleMotionFrame, HalfATurnCountsBothWays) {
    EXPECT_EQ(half_turned_bar(4).meeting(), Meeting::meeting);
    EXPECT_EQ(half_turned_bar(-4).meeting(), Meeting::meeting) << "the bar has two arms";
    EXPECT_EQ(half_turned_bar(8.25).meeting(), Meeting::apart);
    auto arm = half_turned_bar(4);
    arm.a[0] = {0, 0, 0.25}, arm.a[1] = {0, 0.25, -0.25}; // along x from 0 to 8
    for (const double side : {1.0, -1.0}) {
        arm.b = half_turned_bar(side * 4).b;
        arm.to[0] = pose_of(Eigen::Quaterniond(0, 0, 0, 1));
        EXPECT_EQ(arm.meeting(), Meeting::meeting) << "either way, " << side;
        arm.to[0] = pose_of(about_z(half_turn - 0.25));
        EXPECT_EQ(arm.meeting(), side > 0 ? Meeting::meeting : Meeting::apart) << "the shorter way, " << side;
        arm.to[0] = pose_of(about_z(half_turn + 0.25));
        EXPECT_EQ(arm.meeting(), side < 0 ? Meeting::meeting : Meeting::apart) << "the shorter way, " << side;
    }
}

/// A point of the mesh far from its axis moves on a long arc, whose sagitta 1000 (1 - cos(0.25)) is 31.
TEST(OracleMotionFrame, AFarAxisMakesALongArc) {
    TurningPair pair{moved(unit, 1000, 0, 0), unit, {}, {pose_of(about_z(0.5)), {}}};
    const auto at = [&](double radius, double angle) {
        const auto place = radius * (about_z(angle) * Eigen::Vector3d::UnitX());
        pair.b = moved(unit, place.x(), place.y(), 0.25);
        return pair.meeting();
    };
    EXPECT_EQ(at(1000.5, 0.25), Meeting::meeting) << "on the arc";
    EXPECT_EQ(at(969, 0.25), Meeting::apart) << "on the chord";
    EXPECT_EQ(at(1004, 0.25), Meeting::apart);
    EXPECT_EQ(at(1000.5, 0.51), Meeting::apart) << "beyond the end";
    EXPECT_EQ(pair.truth(Precision::fp32).undecided.size(), 0u);
}

/// Equal rotations make straight paths, also when their quaternions have opposite signs: nothing is
/// undecided.
TEST(OracleMotionFrame, EqualRotationsAreStraight) {
    const Eigen::Quaterniond q(0.5, 0.5, 0.5, 0.5), negative(-0.5, -0.5, -0.5, -0.5);
    for (const auto& last : {q, negative}) {
        TurningPair pair{unit, moved(unit, 0, 0, 0), {}, {}};
        pair.from = {pose_of(q), pose_of(q, {2, -4, 1})};
        pair.to = {pose_of(last), pose_of(last, {2, 4, 1})};
        EXPECT_EQ(pair.meeting(), Meeting::apart);
        for (auto* poses : {&pair.from, &pair.to}) (*poses)[1].translation.z() = 0;
        for (auto* poses : {&pair.from, &pair.to}) (*poses)[1].translation.x() = 1;
        EXPECT_EQ(pair.meeting(), Meeting::meeting) << "they touch in one instant";
    }
    oracle::Turn none(pose_of(q), pose_of(negative));
    EXPECT_EQ(none.angle, 0);
    oracle::Turn small(pose_of(q), pose_of(Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5 + 0x1p-53)));
    EXPECT_GT(small.angle, 0);
}

/// The path of the declaration, against Eigen's slerp.
TEST(OracleMotionFrame, ArcsFollowTheRotation) {
    Random random(3);
    for (int round = 0; round < 200; ++round) {
        const auto from = pose_of(random.rotation());
        auto to = pose_of(random.rotation());
        if (round % 4 == 0) to.rotation = Eigen::AngleAxisd(1e-7, random.direction()) * from.rotation;
        const oracle::Turn turned(from, to);
        std::array<Eigen::Vector3d, 4> corners;
        for (auto& c : corners) c = 10 * random.uniform() * random.direction();
        MovingTetra moving;
        turned.bend(moving, corners, false);
        const double angle = moving.angle;
        for (const double s : {0.0, 0.25, 0.5, 0.875, 1.0})
            for (unsigned i = 0; i < 4; ++i) {
                const Eigen::Vector3d chord =
                    (1 - s) * (from.rotation * corners[i]) + s * (to.rotation * corners[i]);
                const Eigen::Vector3d bend = from.rotation.slerp(s, to.rotation) * corners[i] - chord;
                for (unsigned axis = 0; axis < 3; ++axis)
                    EXPECT_NEAR(bend[axis],
                                (std::cos(s * angle) - 1 + s * (1 - std::cos(angle))) * moving.across[i][axis]
                                    + (std::sin(s * angle) - s * std::sin(angle)) * moving.along[i][axis],
                                1e-13);
                EXPECT_LE(bend.norm(), turned.leaves_chord(corners) + 1e-14);
            }
    }
}

/// Random bodies that turn: overlaps at many times imply a meeting, few meetings are found by the truth only,
/// and few pairs are undecided.
TEST(OracleMotionFrame, RandomTurnsAgreeWithManyTimes) {
    Random random(5);
    std::array<unsigned, 3> counts{};
    unsigned only_truth = 0;
    for (int round = 0; round < 400; ++round) {
        TurningPair pair{unit, unit, {}, {}};
        for (auto* corners : {&pair.a, &pair.b})
            for (auto& corner : *corners)
                for (auto& x : corner) x = random.uniform(-1, 1);
        for (auto* poses : {&pair.from, &pair.to})
            for (auto& pose : *poses)
                pose = pose_of(random.rotation(), 2 * random.uniform() * random.direction());
        const auto meeting = pair.meeting();
        ++counts[static_cast<unsigned>(meeting)];
        const bool sampled = pair.overlap_at_a_step(100);
        if (sampled) {
            EXPECT_EQ(meeting, Meeting::meeting) << round;
        }
        only_truth += meeting == Meeting::meeting && !sampled;
    }
    EXPECT_GT(counts[0], 50u);
    EXPECT_GT(counts[1], 50u);
    EXPECT_EQ(counts[2], 0u);
    EXPECT_LT(only_truth, 10u);
}

/// Every pair of tetrahedra whose bodies may meet, and of setting self, one by one from straight corners.
std::vector<Pair> pairs_one_by_one(const Scene& scene, const std::array<Frame, 2>& frames, SelfPairs self) {
    const auto from = oracle::world_of(scene, frames[0], Precision::fp32, Origin::world);
    const auto to = oracle::world_of(scene, frames[1], Precision::fp32, Origin::world);
    std::vector<Pair> result;
    for (std::uint32_t a = 0; a < from.size(); ++a)
        for (std::uint32_t b = a; b < from.size(); ++b) {
            if (!may_meet(scene, a, b) || (a == b && self == SelfPairs::off)) continue;
            const auto& mesh = scene.meshes[scene.bodies[b].mesh];
            for (std::uint32_t t = 0; t < from[a].size(); ++t)
                for (std::uint32_t u = a == b ? t + 1 : 0; u < from[b].size(); ++u) {
                    const auto shared = [&](std::uint32_t v) {
                        return std::ranges::count(mesh.tetrahedra[u], v) > 0;
                    };
                    if (a == b && std::ranges::any_of(mesh.tetrahedra[t], shared)) continue;
                    const auto found =
                        meet_in_motion(straight(from[a][t], to[a][t]), straight(from[b][u], to[b][u]));
                    if (found.meeting == Meeting::meeting) result.push_back({a, t, b, u});
                }
        }
    std::ranges::sort(result);
    return result;
}

/// Two deforming boxes of the same mesh that pass through each other, and a fixed one.
struct PassingBoxes {
    Scene scene;
    std::array<Frame, 2> frames;

    PassingBoxes() {
        Random random(9);
        scene.meshes = {shaken_box(2, random)};
        scene.bodies = {{.deformable = true}, {.deformable = true}, {.fixed = true}};
        for (unsigned end = 0; end < 2; ++end) {
            frames[end].poses.resize(3);
            frames[end].poses[2].translation = {0.25, 0.75, 0};
            frames[end].deformed.resize(3);
            for (unsigned body = 0; body < 2; ++body)
                for (const auto& v : scene.meshes[0].vertices)
                    frames[end].deformed[body].emplace_back(v.x() + (body == end ? 1.5 : -1.5),
                                                            v.y() + random.uniform(-0.3, 0.3), v.z());
        }
    }
};

TEST(OracleMotionFrame, EqualsPairsOneByOne) {
    const PassingBoxes passing;
    const auto& [from, to] = passing.frames;
    for (const auto self : {SelfPairs::off, SelfPairs::on}) {
        const auto expected = pairs_one_by_one(passing.scene, passing.frames, self);
        const auto truth =
            motion_truth(passing.scene, from, to, {Precision::fp32, Placement::rounded, Origin::world, self});
        EXPECT_TRUE(truth.colliding == expected) << truth.colliding.size() << " " << expected.size();
        EXPECT_TRUE(truth.undecided.empty());
        EXPECT_GT(expected.size(), 500u);
        EXPECT_EQ(std::ranges::any_of(expected, [](const Pair& p) { return p.body_a == p.body_b; }),
                  self == SelfPairs::on);
        for (const auto& frame : passing.frames) {
            const auto still =
                frame_truth(passing.scene, frame, {Precision::fp32, Placement::rounded, Origin::world, self});
            for (const auto* pairs : {&still.touching, &still.overlapping})
                EXPECT_TRUE(std::ranges::includes(truth.colliding, *pairs)) << "pairs of an end";
            EXPECT_LT(still.touching.size() + still.overlapping.size(), expected.size());
        }
    }
}

/// Tetrahedra that either frame skips, and those with a vertex that is not finite in one frame.
TEST(OracleMotionFrame, SkippedAndInvalidTetrahedraAreInNoPair) {
    PassingBoxes passing;
    auto& [from, to] = passing.frames;
    auto expected = motion_truth(passing.scene, from, to, Precision::fp32).colliding;
    from.skipped = {{3, 4}, {}, {}};
    to.skipped = {{}, {20, 21}, {}};
    to.deformed[1][0].x() = std::numeric_limits<double>::infinity();
    const auto truth = motion_truth(passing.scene, from, to, Precision::fp32);
    ASSERT_FALSE(truth.invalid.empty());
    const auto first = std::erase_if(
        expected, [](const Pair& p) { return p.body_a == 0 && (p.tet_a == 3 || p.tet_a == 4); });
    const auto last = std::erase_if(expected, [](const Pair& p) {
        return (p.body_a == 1 && (p.tet_a == 20 || p.tet_a == 21))
               || (p.body_b == 1 && (p.tet_b == 20 || p.tet_b == 21));
    });
    std::erase_if(expected, [&](const Pair& p) {
        return std::ranges::binary_search(truth.invalid, std::array{p.body_a, p.tet_a})
               || std::ranges::binary_search(truth.invalid, std::array{p.body_b, p.tet_b});
    });
    EXPECT_GT(first, 10u);
    EXPECT_GT(last, 10u);
    EXPECT_TRUE(truth.colliding == expected) << truth.colliding.size() << " " << expected.size();
}

TEST(OracleMotionFrame, RefusesTooLittleMemoryAndReportsProgress) {
    const PassingBoxes passing;
    const auto& [from, to] = passing.frames;
    EXPECT_THROW(motion_truth(passing.scene, from, to, Precision::fp32, {.memory = 1000}), InputError);
    double last = 0;
    const auto truth = motion_truth(passing.scene, from, to, Precision::fp32,
                                    {.report = [&](double fraction, std::uint64_t) { last = fraction; }});
    EXPECT_EQ(last, 1);
    EXPECT_GT(truth.tiers[static_cast<unsigned>(MeetingTier::intervals)], 0u);
}

} // namespace
} // namespace tandem
