// SPDX-License-Identifier: MIT
// The difficulty of every family affects its metric, and the methods known to fail do fail.
#include "tests/hard/support.h"
#include "tests/support/test.h"

#include "algorithms/bounds/geometry.h"
#include "geometry/contact_truth.h"
#include "harness/verify/oracle/motion_truth.h"
#include "harness/verify/world_vertices.h"

namespace tandem {
namespace {

using namespace hard_test;

#ifdef TANDEM_SANITIZED
constexpr std::uint64_t few = 52;
constexpr std::uint64_t many = 416;
#else
constexpr std::uint64_t few = 104;
constexpr std::uint64_t many = 2080;
#endif

/// A property of pairs; its fraction in a family is measured.
using Property = std::function<bool(const HardPair&)>;

double fraction(const HardFamily& family, double e, std::uint64_t count, const Property& has) {
    std::uint64_t found = 0;
    for (std::uint64_t i = 0; i < count; ++i) found += has(hard_pair(family, 3, i, e)) ? 1 : 0;
    return static_cast<double>(found) / static_cast<double>(count);
}

double mean(const HardFamily& family, double e, const std::function<double(const HardPair&)>& value) {
    double sum = 0;
    for (std::uint64_t i = 0; i < few; ++i) sum += value(hard_pair(family, 3, i, e));
    return sum / static_cast<double>(few);
}

using Metric = std::function<double(const HardFamily&, double)>;

/// Fraction of intersecting pairs that slabs with the paper's tolerance miss.
Metric missed_by_slabs(int k, bool unit) {
    return [k, unit](const HardFamily& family, double e) {
        const auto along = directions({.k = k});
        return fraction(family, e, many, [&](const HardPair& pair) {
            return !slabs_overlap(pair, along, unit, 10 * 0x1p-23F) && meets(relation_of(pair));
        });
    };
}

/// Candidates per intersecting pair, with integer directions and a tolerance.
Metric candidates_per_intersection(int k, float tolerance = 0) {
    return [k, tolerance](const HardFamily& family, double e) {
        const auto along = directions({.k = k});
        const auto candidates = fraction(
            family, e, many, [&](const HardPair& p) { return slabs_overlap(p, along, false, tolerance); });
        const auto intersecting =
            fraction(family, e, many, [](const HardPair& p) { return meets(relation_of(p)); });
        return candidates / std::max(intersecting, 1e-9);
    };
}

/// Fraction of pairs that the plain test decides wrongly in single precision.
double wrong_in_float(const HardFamily& family, double e) {
    return fraction(family, e, many,
                    [](const HardPair& p) { return plain_meets<float>(p) != meets(relation_of(p)); });
}

double wrong_in_double(const HardFamily& family, double e) {
    return fraction(family, e, many,
                    [](const HardPair& p) { return plain_meets<double>(p) != meets(relation_of(p)); });
}

Metric having(Relation relation) {
    return [relation](const HardFamily& family, double e) {
        return fraction(family, e, few, [=](const HardPair& p) { return relation_of(p) == relation; });
    };
}

double size_of(const FloatCorners& corners) {
    double size = 0;
    for (const auto& c : corners)
        for (unsigned axis = 0; axis < 3; ++axis)
            size = std::max(size,
                            std::abs(static_cast<double>(c[axis]) - static_cast<double>(corners[0][axis])));
    return size;
}

double size_of_b(const HardFamily& family, double e) {
    return mean(family, e, [](const HardPair& p) { return size_of(p.b); });
}

double signed_volume(const FloatCorners& corners) {
    const auto c = widened(corners);
    double d[3][3];
    for (unsigned i = 0; i < 3; ++i)
        for (unsigned axis = 0; axis < 3; ++axis) d[i][axis] = c[i + 1][axis] - c[0][axis];
    return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1])
           - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0])
           + d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

double volume_of_a(const HardFamily& family, double e) {
    return mean(family, e, [](const HardPair& p) { return std::abs(signed_volume(p.a)); });
}

double flatness_of_a(const HardFamily& family, double e) { return -volume_of_a(family, e); }

double slowest_tier(const HardFamily& family, double e) {
    return fraction(family, e, few, [](const HardPair& p) {
        return decide(widened(p.a), widened(p.b)).tier >= Tier::big_integers;
    });
}

double subnormals(const HardFamily& family, double e) {
    return fraction(family, e, few, [](const HardPair& p) {
        return std::any_of(p.a.begin(), p.a.end(),
                           [](const auto& c) { return std::fpclassify(c[0]) == FP_SUBNORMAL; });
    });
}

double invalid_b(const HardFamily& family, double e) {
    return fraction(family, e, few, [](const HardPair& p) {
        return std::any_of(p.b.begin(), p.b.end(),
                           [](const auto& c) { return !std::isfinite(c[0] + c[1] + c[2]); });
    });
}

Metric of_contact(double (*value)(const ContactTruth&)) {
    return [value](const HardFamily& family, double e) {
        return mean(family, e, [&](const HardPair& p) {
            const auto truth = contact_truth(widened(p.a), widened(p.b));
            return truth ? value(*truth) : 0;
        });
    };
}

double depth(const ContactTruth& truth) { return truth.depth; }
double shallowness(const ContactTruth& truth) { return -truth.depth; }
double normals(const ContactTruth& truth) { return static_cast<double>(truth.normals.size()); }

Scene scene_of(const HardFamily& family, double e) {
    Random random(3);
    if (family.scene != nullptr) return family.scene(random, e);
    return hard_pair_scene(family, 3, e, {64, 16});
}

/// Intersecting pairs of the first frame.
double meeting(const HardFamily& family, double e) {
    const auto scene = scene_of(family, e);
    const auto truth = frame_truth(scene, scene.frame(0), Precision::fp32);
    return static_cast<double>(truth.touching.size() + truth.overlapping.size());
}

double overlapping(const HardFamily& family, double e) {
    const auto scene = scene_of(family, e);
    return static_cast<double>(frame_truth(scene, scene.frame(0), Precision::fp32).overlapping.size());
}

/// Intersecting pairs of the first frame that are lost where vertices are rounded in world coordinates.
double lost_by_rounding(const HardFamily& family, double e) {
    const auto scene = scene_of(family, e);
    const auto met = [&](const Positions& positions) {
        auto truth = frame_truth(scene, scene.frame(0), positions);
        truth.overlapping.insert(truth.overlapping.end(), truth.touching.begin(), truth.touching.end());
        std::ranges::sort(truth.overlapping);
        return truth.overlapping;
    };
    const auto exact = met({Precision::fp32, Placement::exact}), rounded = met(Precision::fp32);
    return static_cast<double>(std::ranges::count_if(
        exact, [&](const Pair& pair) { return !std::ranges::binary_search(rounded, pair); }));
}

/// Largest difference between a vertex transformed in single and in double precision.
double drift(const HardFamily& family, double e) {
    const auto scene = scene_of(family, e);
    const auto once = world_vertices<float>(scene, scene.frame(0), 0, Origin::world);
    const auto twice = world_vertices<double>(scene, scene.frame(0), 0, Origin::world);
    double most = 0;
    for (std::size_t i = 0; i < once.size(); ++i)
        for (unsigned axis = 0; axis < 3; ++axis)
            most = std::max(most, std::abs(static_cast<double>(once[i][axis]) - twice[i][axis]));
    return most;
}

/// Deviation of the squared norm of the pose's quaternion from 1.
double stretch(const HardFamily& family, double e) {
    return std::abs(scene_of(family, e).frame(0).poses[0].rotation.squaredNorm() - 1);
}

/// Pairs for which only one of the pair and its mirror image is a candidate, with k = 8 from x, y, z and one
/// diagonal.
double asymmetric(const HardFamily& family, double e) {
    const auto along = directions({.k = 8, .coordinate_axes = true});
    double found = 0;
    for (std::uint64_t i = 0; i < many; i += 2)
        found += slabs_overlap(hard_pair(family, 3, i, e), along, false, 0)
                         != slabs_overlap(hard_pair(family, 3, i + 1, e), along, false, 0)
                     ? 1
                     : 0;
    return found;
}

double frames(const HardFamily& family, double e) {
    return static_cast<double>(scene_of(family, e).frame_count);
}

double with_tolerance(const HardFamily& family, double e) {
    return fraction(family, e, few, [](const HardPair& p) {
        return slabs_overlap(p, {{1, 0, 0}}, false, 10 * 0x1p-23F);
    });
}

/// Pairs that meet when coordinates are multiples of 2^-12: of one body, or on the way.
double meeting_when_rounded(const HardFamily& family, double e) {
    const auto scene = scene_of(family, e);
    const auto rounded = [&](std::size_t index) {
        auto frame = scene.frame(index);
        for (auto& vertices : frame.deformed)
            for (auto& v : vertices)
                for (auto& x : v) x = std::round(x * 0x1p12) / 0x1p12;
        return frame;
    };
    const auto self = family.self ? SelfPairs::on : SelfPairs::off;
    return static_cast<double>(motion_truth(scene, rounded(0), rounded(scene.frame_count - 1),
                                            {Precision::fp32, Placement::rounded, Origin::world, self})
                                   .colliding.size());
}

double meeting_within_bodies(const HardFamily& family, double e) {
    const auto scene = scene_of(family, e);
    const auto truth = frame_truth(scene, scene.frame(0),
                                   {Precision::fp32, Placement::rounded, Origin::world, SelfPairs::on});
    return static_cast<double>(truth.touching.size() + truth.overlapping.size());
}

/// Largest distance of a vertex of body 0 from frame 0 to frame 1, without the motion of body 1.
double way(const HardFamily& family, double e) {
    const auto scene = scene_of(family, e);
    std::array<std::vector<std::array<double, 3>>, 2> at[2];
    for (unsigned end = 0; end < 2; ++end)
        for (unsigned body = 0; body < 2; ++body)
            at[end][body] = world_vertices<double>(scene, scene.frame(end), body, Origin::world);
    double most = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        double square = 0;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const double moved = at[1][0][i][axis] - at[0][0][i][axis];
            square += std::pow(moved - (at[1][1][0][axis] - at[0][1][0][axis]), 2);
        }
        most = std::max(most, std::sqrt(square));
    }
    return most;
}

double flatness_of_body(const HardFamily& family, double e) {
    return -volume(scene_of(family, e).meshes.front());
}

double largest_coordinate(const HardFamily& family, double e) {
    const auto scene = scene_of(family, e);
    return scene.frame(1).deformed[0][0].cwiseAbs().maxCoeff();
}

/// A family, a metric, and difficulties at which it is low and high.
struct Case {
    const char* family;
    Metric metric;
    double low, high;
};

const std::vector<Case> cases{{"slab-touch", missed_by_slabs(18, true), 1, 1000},
                              {"corner-cancellation", missed_by_slabs(8, false), 1, 1000},
                              {"far-origin", having(Relation::touching), 1, 1e7},
                              {"rigid-transform", drift, 1, 1e5},
                              {"accumulated-motion", stretch, 1, 10000},
                              {"long-quaternion", stretch, 1e-6, 0.5},
                              {"mirror", asymmetric, 2, 0.5},
                              {"thin-plates", candidates_per_intersection(18), 1, 1e-3},
                              {"subnormal", subnormals, 0, 140},
                              {"not-finite", invalid_b, 0, 4},
                              {"tolerance-scale", candidates_per_intersection(18, 10 * 0x1p-23F), 1, 1e-6},
                              {"tolerance-gap", with_tolerance, 1, 0},
                              {"refit-order", frames, 2, 9},
                              {"touch", wrong_in_float, 1, 9},
                              {"touch-24bit", wrong_in_double, 10, 19},
                              {"units-apart", having(Relation::disjoint), -1, 1},
                              {"rounded-onto-face", wrong_in_float, 1e6, 0},
                              {"coplanar", size_of_b, 1, 19},
                              {"shared", size_of_b, 1, 19},
                              {"nested", of_contact(shallowness), 0, 0.9},
                              {"sliver", flatness_of_a, 0.1, 1e-6},
                              {"parallel-edges", wrong_in_float, 0.1, 1e-6},
                              {"scale-ratio", wrong_in_float, 1, 1e-6},
                              {"mixed-exponents", slowest_tier, 0, 120},
                              {"scale", wrong_in_float, 0, -60},
                              {"zero-volume", having(Relation::touching), 1000, 2},
                              {"inverted", size_of_b, 1, 19},
                              {"opposing-faces", of_contact(normals), 0.1, 1e-8},
                              {"edge-crossing", of_contact(depth), 1e-3, 0.1},
                              {"deep", of_contact(depth), 0.01, 0.4},
                              {"ties", of_contact(normals), 0.1, 0},
                              {"configurations", overlapping, 0, 0.125},
                              {"vanishing-depth", of_contact(shallowness), 8, 16},
                              {"interior-faces", meeting, 0.001, 0.5},
                              {"plane-division", of_contact(depth), 1e-5, 0.1},
                              {"inverting", volume_of_a, 0, 1},
                              {"self-intersecting", meeting, 0, 3},
                              {"collapsing", flatness_of_a, 0, 1},
                              {"all-overlap", meeting, 2, 8},
                              {"one-huge", meeting, 3, 30},
                              {"equal-codes", meeting, 2, 20},
                              {"exact-capacity", meeting, 7, 8},
                              {"counter-wrap", meeting, 4, 5},
                              {"nearly-shared", meeting_when_rounded, 1, 6},
                              {"folded-flat", meeting_when_rounded, 1, 6},
                              {"inverted-elements", meeting_within_bodies, 0.25, 3},
                              {"coil", meeting_when_rounded, 1, 6},
                              {"wedges", flatness_of_body, 1, 3},
                              {"grazing-vertex", meeting_when_rounded, 4, 20},
                              {"grazing-edge", meeting_when_rounded, 4, 20},
                              {"tunnelling", meeting_when_rounded, 4, 20},
                              {"one-instant", meeting_when_rounded, 4, 20},
                              {"inverting-on-the-way", meeting_when_rounded, 4, 20},
                              {"sliding-edges", meeting_when_rounded, 4, 20},
                              {"half-turn", way, 16, 64},
                              {"far-lever", way, 16, 1024},
                              {"tiny-turn", way, 14, 4},
                              {"equal-speed", largest_coordinate, 3, 20},
                              {"far", lost_by_rounding, 1, 1e6}};

TEST(HardDifficulty, MovesItsMetric) {
    ASSERT_EQ(cases.size(), hard_families().size());
    for (const auto& [name, metric, low, high] : cases) {
        const auto& family = hard_family(name);
        const double at_low = metric(family, low);
        const double at_high = metric(family, high);
        EXPECT_LT(at_low, at_high) << name;
    }
}

/// Known causes of errors: methods that fail, and one that does not.
TEST(HardDifficulty, KnownFailuresOccur) {
    const auto& aligned = hard_family("slab-touch");
    EXPECT_GT(missed_by_slabs(18, true)(aligned, 1000), 0.01);
    EXPECT_EQ(missed_by_slabs(18, false)(aligned, 1000), 0);
    const auto& bits = hard_family("touch-24bit");
    EXPECT_GT(wrong_in_float(bits, 19), 0.02);
    EXPECT_GT(wrong_in_double(bits, 19), 0.005);
}

/// Standard direction sets are symmetric: a pair and its mirror image are both candidates or both not.
TEST(HardDifficulty, MirrorImagesAreEquallyCandidates) {
    const auto& family = hard_family("mirror");
    for (const int k : {6, 8, 14, 18, 26}) {
        const auto along = directions({.k = k});
        for (std::uint64_t i = 0; i < few; i += 2)
            EXPECT_EQ(slabs_overlap(hard_pair(family, 3, i, 0.5), along, false, 0),
                      slabs_overlap(hard_pair(family, 3, i + 1, 0.5), along, false, 0))
                << k;
    }
}

} // namespace
} // namespace tandem
