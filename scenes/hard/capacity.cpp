// SPDX-License-Identifier: MIT
// Group f: queues, stacks and counters.
#include "scenes/hard/families.h"
#include "scenes/hard/maker.h"
#include "scenes/hard/solids.h"

#include <algorithm>
#include <cmath>

namespace tandem::hard {

namespace {

using Vector = Eigen::Vector3d;

/// Tetrahedra that contain the ball of radius 1/2 about the origin, so that any two overlap.
std::vector<FloatCorners> about_origin(Random& random, std::uint64_t count) {
    std::vector<FloatCorners> result;
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto q = random.rotation().toRotationMatrix();
        auto& corners = result.emplace_back();
        const Vector cube[] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
        for (unsigned c = 0; c < 4; ++c)
            for (int axis = 0; axis < 3; ++axis)
                corners[c][static_cast<unsigned>(axis)] = static_cast<float>(q.row(axis).dot(cube[c]));
    }
    return result;
}

std::uint64_t count_of(double x) { return static_cast<std::uint64_t>(x); }

constexpr std::uint64_t stacked = 4; ///< tetrahedra of a body

Scene all_overlap(Random& random, double bodies) {
    return still({separate("stack", about_origin(random, stacked))}, std::vector<Pose>(count_of(bodies)));
}

std::uint64_t all_overlap_meeting(double bodies) {
    const auto n = count_of(bodies);
    return n * (n - 1) / 2 * stacked * stacked;
}

/// Body 0 contains a row of small bodies, 4 apart, which do not overlap each other.
Scene one_huge(Random& random, double bodies) {
    const double half = 2 * bodies;
    const Corners huge{Vector{-2 * half, -half, -half}, Vector{2 * half, -half, -half},
                       Vector{0, half, -half}, Vector{0, 0, 3 * half}};
    FloatCorners corners;
    for (unsigned i = 0; i < 4; ++i)
        for (int axis = 0; axis < 3; ++axis)
            corners[i][static_cast<unsigned>(axis)] = static_cast<float>(huge[i][axis]);
    std::vector<Mesh> meshes{separate("huge", {corners}), separate("small", about_origin(random, 1))};
    const auto small = count_of(bodies);
    auto scene = still(std::move(meshes), {});
    std::vector<Pose> poses{at({0, 0, 0})};
    scene.bodies.push_back({.mesh = 0});
    for (std::uint64_t i = 0; i < small; ++i) {
        scene.bodies.push_back({.mesh = 1});
        poses.push_back(at({0, 0, 0}));
        poses.back().translation.x() = 4 * static_cast<double>(i) - half + 2;
        poses.back().translation.y() = -half / 2;
    }
    scene.frame = [poses](std::size_t) {
        return Frame{poses, std::vector<std::vector<Vector>>(poses.size())};
    };
    return scene;
}

std::uint64_t one_huge_meeting(double bodies) { return count_of(bodies); }

/// Bodies 0 and 1 have tetrahedra of one centroid, so that all Morton codes are equal. Body 2 is a bar of
/// many cells through both.
Scene equal_codes(Random& random, double tetrahedra) {
    auto nested = about_origin(random, count_of(tetrahedra));
    for (std::size_t i = 0; i < nested.size(); ++i)
        for (auto& corner : nested[i])
            for (auto& x : corner) x *= 1 + static_cast<float>(i % 8) / 8;
    const auto bar = grid({64, 1, 1}, {64, 0.25, 0.25});
    return still({separate("nested", nested), separate("nested again", nested), bar},
                 {at({0, 0, 0}), at({0.25, 0, 0}), at({0, 0, 0})});
}

/// One tetrahedron that overlaps `pairs` others.
Scene exact_capacity(Random& random, double pairs) {
    return still(
        {separate("one", about_origin(random, 1)), separate("many", about_origin(random, count_of(pairs)))},
        {at({0, 0, 0}), at({0, 0, 0})});
}

std::uint64_t exact_capacity_meeting(double pairs) { return count_of(pairs); }

/// Two bodies of 2^(e / 2) tetrahedra; the first has twice as many when e is odd.
Scene counter_wrap(Random& random, double exponent) {
    const auto e = count_of(exponent);
    return still({separate("some", about_origin(random, std::uint64_t{1} << (e + 1) / 2)),
                  separate("others", about_origin(random, std::uint64_t{1} << e / 2))},
                 {at({0, 0, 0}), at({0, 0, 0})});
}

std::uint64_t counter_wrap_meeting(double exponent) { return std::uint64_t{1} << count_of(exponent); }

constexpr HardFamily capacity_table[] = {
    {.row = 39,
     .group = 'f',
     .name = "all-overlap",
     .summary = "copies of one body at one position, all tetrahedra overlap",
     .knob = {"bodies", 2, 10000, 16},
     .truth = HardTruth::construction,
     .metric = "pairs, retries",
     .fails = "queues and pair buffers without a bound",
     .scene = all_overlap,
     .meeting = all_overlap_meeting},
    {.row = 40,
     .group = 'f',
     .name = "one-huge",
     .summary = "one huge tetrahedron around a row of small bodies",
     .knob = {"small bodies", 1, 100000, 200},
     .truth = HardTruth::construction,
     .metric = "pairs, balance",
     .fails = "work shared by bodies",
     .scene = one_huge,
     .meeting = one_huge_meeting},
    {.row = 41,
     .group = 'f',
     .name = "equal-codes",
     .summary = "tetrahedra of one centroid and a long bar through them",
     .knob = {"tetrahedra of a body", 2, 4096, 100},
     .truth = HardTruth::oracle,
     .metric = "MISS, pairs",
     .fails = "builders that split by differing codes",
     .scene = equal_codes},
    {.row = 42,
     .group = 'f',
     .name = "exact-capacity",
     .summary = "a given number of pairs, for buffers of one less, equal and one more",
     .knob = {"pairs", 1, 1e6, 1000},
     .truth = HardTruth::construction,
     .metric = "retries",
     .fails = "overflow that is not noticed",
     .scene = exact_capacity,
     .meeting = exact_capacity_meeting},
    {.row = 43,
     .group = 'f',
     .name = "counter-wrap",
     .summary = "2^e pairs",
     .knob = {"e", 1, 34, 12},
     .truth = HardTruth::construction,
     .metric = "pairs",
     .fails = "counters of 32 bits, from e = 31 or 32 on",
     .scene = counter_wrap,
     .meeting = counter_wrap_meeting}};

} // namespace

std::span<const HardFamily> capacity_families() { return capacity_table; }

} // namespace tandem::hard
