// SPDX-License-Identifier: MIT
// What the rounding of vertices changes, against the input's doubles.
#include "harness/verify/accuracy/truths.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using Vector = Eigen::Vector3d;

/// Two corners of cubes with edges of 2, the second moved.
Scene two_corners(const Vector& second) {
    Scene scene;
    scene.name = scene.key = "corners";
    scene.meshes = {one_tetrahedron(2)};
    scene.bodies = {{}, {}};
    scene.frame = [second](std::size_t) {
        Frame frame;
        frame.poses = {{}, {Eigen::Quaterniond::Identity(), second}};
        frame.deformed.resize(2);
        return frame;
    };
    return scene;
}

RoundingErrors rounding_in(const Scene& scene, const Geometry& geometry, std::vector<Pair> found = {},
                           TruthAmount amount = TruthAmount::contacts) {
    const FrameRange range(scene, 0, 0);
    Truths truths(scene, range, amount, 0);
    FrameAnswer answer;
    answer.download = [&] { return found; };
    const auto errors = truths.errors(geometry, 0, answer);
    EXPECT_TRUE(errors.rounding);
    return errors.rounding.value_or(RoundingErrors{});
}

const Pair only{0, 0, 1, 0};
/// Floats from here on are whole numbers.
const Vector whole_floats = Vector::Constant(0x1p23);

TEST(AccuracyRounding, APairIsLostWhereVerticesRoundApart) {
    const auto far = moved(two_corners({0.6, 0.6, 0.6}), whole_floats); // 1.8 < 2 <= 3
    const auto lost = rounding_in(far, {});
    EXPECT_EQ(lost, (RoundingErrors{1, 1, 0, 1, lost.depth_change}));
    EXPECT_NEAR(*lost.depth_change, 0.2 / std::sqrt(3.0), 1e-8) << "the whole depth";
    EXPECT_EQ(rounding_in(far, {}, {only}).missed, 0u) << "a candidate, although its vertices are apart";
    EXPECT_EQ(rounding_in(far, {.precision = Precision::fp64}).lost, 0u);
    EXPECT_EQ(rounding_in(far, {.origin = Origin::automatic}).lost, 0u);
    EXPECT_EQ(rounding_in(far, {.placement = Placement::exact}, {only}),
              (RoundingErrors{1, 0, 0, 0, lost.depth_change}))
        << "no pair, but its depth is of the rounded vertices";
    EXPECT_EQ(rounding_in(far, {.placement = Placement::exact}).missed, 1u);
    EXPECT_FALSE(rounding_in(far, {}, {}, TruthAmount::pairs).depth_change);
}

TEST(AccuracyRounding, APairIsAddedWhereVerticesRoundTogether) {
    const auto far = moved(two_corners({2.4, 0, 0}), whole_floats);
    EXPECT_EQ(rounding_in(far, {}, {only}), (RoundingErrors{0, 0, 1, 0, 0})) << "it touches";
    const auto deeper = moved(two_corners({0.75, 0.75, 0.375}), whole_floats);
    const auto changed = rounding_in(deeper, {}, {only});
    EXPECT_EQ(changed, (RoundingErrors{1, 0, 0, 0, changed.depth_change}));
    EXPECT_NEAR(*changed.depth_change, 0.125 / std::sqrt(3.0), 1e-15) << "1.875 becomes 2";
}

/// Against every pair of the frame, decided one by one.
TEST(AccuracyRounding, CountsEveryPairOfAFarFrame) {
    const Vector offset(4.1e6, -2.3e6, 1e5);
    const auto far = moved(crowd(3, 6, 1.2), offset);
    const auto frame = far.frame(0);
    std::vector<Pair> pairs;
    const auto tetrahedra = [&](std::uint32_t body) {
        return static_cast<std::uint32_t>(far.meshes[far.bodies[body].mesh].tetrahedra.size());
    };
    for (std::uint32_t a = 0; a < far.bodies.size(); ++a)
        for (std::uint32_t b = a + 1; b < far.bodies.size(); ++b)
            for (std::uint32_t t = 0; t < tetrahedra(a); ++t)
                for (std::uint32_t u = 0; u < tetrahedra(b); ++u) pairs.push_back({a, t, b, u});
    const auto rounded = decide_pairs(far, frame, Precision::fp32, pairs);
    const auto exact = decide_pairs(far, frame, {Precision::fp32, Placement::exact}, pairs);
    const auto meets = [](const Decision& d) {
        return d.relation == Relation::touching || d.relation == Relation::overlapping;
    };
    RoundingErrors right;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        right.meeting += meets(exact[i]);
        right.lost += meets(exact[i]) && !meets(rounded[i]);
        right.extra += !meets(exact[i]) && meets(rounded[i]);
    }
    right.missed = right.meeting;
    EXPECT_GT(right.lost, 20u);
    EXPECT_GT(right.extra, 20u);
    EXPECT_EQ(rounding_in(far, {}, {}, TruthAmount::pairs), right);
    const auto counted = rounding_in(far, {.origin = Origin::automatic}, {}, TruthAmount::pairs);
    EXPECT_EQ(counted, (RoundingErrors{right.meeting, 0, 0, right.meeting, {}}));
}

/// No second truth is needed for vertices that floats represent, wherever poses keep them so.
TEST(AccuracyRounding, SeesWhetherAVertexIsRounded) {
    const auto is_rounded = [](const Scene& scene, Precision precision, Origin setting = Origin::world) {
        const FrameRange range(scene, 0, 0);
        return rounds({scene,
                       range.frame(0),
                       range.frame(0, setting),
                       range.origin(setting),
                       {precision, Placement::rounded, setting}});
    };
    EXPECT_FALSE(is_rounded(two_corners({0.75, 0, 0x1p-20}), Precision::fp32));
    EXPECT_TRUE(is_rounded(two_corners({0.75, 0, 0x1p-26}), Precision::fp32));
    EXPECT_FALSE(is_rounded(two_corners({0.75, 0, 0x1p-26}), Precision::fp64));
    const auto far = moved(two_corners({0.75, 0, 0}), whole_floats);
    EXPECT_TRUE(is_rounded(far, Precision::fp32));
    EXPECT_FALSE(is_rounded(far, Precision::fp32, Origin::automatic));
    auto turned = two_corners({0.75, 0, 0});
    turned.frame = [still = turned.frame](std::size_t i) {
        auto frame = still(i);
        frame.poses[1].rotation = Eigen::Quaterniond(0, 0, 1, 0); // half a turn
        return frame;
    };
    EXPECT_FALSE(is_rounded(turned, Precision::fp32));
    turned.frame = [still = turned.frame](std::size_t i) {
        auto frame = still(i);
        frame.poses[1].rotation = Eigen::Quaterniond(1, 0, 1, 0).normalized();
        return frame;
    };
    EXPECT_TRUE(is_rounded(turned, Precision::fp64));
    const auto near = rounding_in(two_corners({0.75, 0, 0}), {}, {only});
    EXPECT_EQ(near, (RoundingErrors{1, 0, 0, 0, 0}));
}

TEST(AccuracyRounding, FramesAreSummed) {
    RoundingErrors sum{1, 2, 3, 4, {}};
    sum.add({10, 20, 30, 40, 0.5});
    sum.add({100, 200, 300, 400, 0.25});
    EXPECT_EQ(sum, (RoundingErrors{111, 222, 333, 444, 0.5}));
}

} // namespace
} // namespace tandem
