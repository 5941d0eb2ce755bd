// SPDX-License-Identifier: MIT
// Group e: elements of deforming meshes.
#include "scenes/hard/families.h"
#include "scenes/hard/maker.h"
#include "scenes/hard/solids.h"
#include "scenes/motion.h"

#include <cmath>

namespace tandem::hard {

namespace {

using Vector = Eigen::Vector3d;

/// a's last corner is moved through the opposite face by `through` times its height. a is flat at 0 and
/// inverted above 0.
HardPair pushed_through(Random& random, double through, std::uint64_t) {
    auto [a, b] = near_pair(random);
    const Vector normal = (a[1] - a[0]).cross(a[2] - a[0]).normalized();
    a[3] -= (1 + through) * normal.dot(a[3] - a[0]) * normal;
    return rounded_pair(random, a, b);
}

/// An element whose height is halved `halvings` times from pair to pair and is 0 in every 32nd pair.
/// Coordinates are integers times powers of two.
HardPair collapsing(Random& random, double halvings, std::uint64_t index) {
    auto [a, b] = touching_integers(random, 3, 3);
    const auto step = static_cast<int>(index % 32);
    a[3].x() *= step == 31 ? 0 : std::ldexp(1.0, -static_cast<int>(halvings) * step);
    return exact_pair(random, a, b, Known::touching);
}

/// A bar bent into a circle until its ends overlap.
Mesh ring(double overlap) {
    constexpr double length = 6, radius = 1;
    auto mesh = grid({24, 2, 2}, {length, 0.5, 0.5});
    const double full = 2 * 3.141592653589793 + overlap;
    for (auto& v : mesh.vertices) {
        const auto [sine, cosine] = sine_cosine(full * (v.x() / length));
        const Vector bent{(radius + v.y()) * sine, (radius + v.y()) * cosine, v.z()};
        for (int axis = 0; axis < 3; ++axis) v[axis] = static_cast<double>(static_cast<float>(bent[axis]));
    }
    mesh.name = "ring";
    complete_mesh(mesh, mesh.name);
    return mesh;
}

/// Two such rings that overlap; a point of one ring can be in two tetrahedra of the other.
Scene self_intersecting(Random& random, double overlap) {
    Pose second = at({0.25, 0.25, 0.125});
    second.rotation = turn(random.direction(), 0.5);
    return still({ring(overlap)}, {at({0, 0, 0}), second});
}

constexpr HardFamily deforming_table[] = {
    {.row = 36,
     .group = 'e',
     .name = "inverting",
     .summary = "an element whose corner is pushed through the opposite face",
     .knob = {"fraction of its height", -1, 1, 0.01},
     .truth = HardTruth::oracle,
     .metric = "CLS",
     .fails = "normals and signs of volume that trust the orientation",
     .pair = pushed_through},
    {.row = 37,
     .group = 'e',
     .name = "self-intersecting",
     .summary = "two bars bent into rings whose ends overlap",
     .knob = {"angle of overlap of the ends", 0, 3, 0.5},
     .truth = HardTruth::oracle,
     .metric = "MISS, share of pairs that overlap doubly",
     .fails = "methods that take a point to be in one element",
     .scene = self_intersecting},
    {.row = 38,
     .group = 'e',
     .name = "collapsing",
     .summary = "an element that loses height from pair to pair until it has none",
     .knob = {"halvings a pair", 0, 4, 1},
     .truth = HardTruth::program,
     .metric = "CLS",
     .fails = "a class that flips on the way to zero",
     .pair = collapsing}};

} // namespace

std::span<const HardFamily> deforming_families() { return deforming_table; }

} // namespace tandem::hard
