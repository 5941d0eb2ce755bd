// SPDX-License-Identifier: MIT
// Group b: overlap tests with a tolerance, and refitted hierarchies.
#include "scenes/hard/families.h"
#include "scenes/hard/maker.h"
#include "scenes/hard/solids.h"

#include <cmath>

namespace tandem::hard {

namespace {

HardPair scaled_pair(Random& random, double size, std::uint64_t) {
    const auto [a, b] = near_pair(random);
    return rounded_pair(random, scaled(a, size), scaled(b, size));
}

/// Faces in the planes x = 0 and x = gap, one behind the other, so that their distance is exactly the gap.
HardPair gap_near_tolerance(Random& random, double units, std::uint64_t) {
    constexpr double tolerance = 10 * 0x1p-23; // the paper's 10 FLT_EPSILON
    const double gap = tolerance + std::round(units) * float_unit(tolerance);
    auto [a, b] = touching_integers(random, 3, 3);
    for (unsigned i = 0; i < 3; ++i) b[i].x() = gap;
    return exact_pair(random, a, b, Known::disjoint);
}

/// Two boxes of tetrahedra with a new random deformation in every frame.
Scene refits(Random& random, double frames) {
    Scene scene;
    scene.meshes = {grid({3, 3, 3}, {1, 1, 1})};
    scene.bodies = {{.deformable = true}, {.deformable = true}};
    scene.frame_count = static_cast<std::size_t>(frames);
    scene.frame = [rest = scene.meshes.front().vertices, seed = random.next()](std::size_t index) {
        Frame frame;
        frame.poses.resize(2);
        frame.deformed.assign(2, rest);
        Random shake(seed + index * 0x9e3779b97f4a7c15u);
        for (unsigned body = 0; body < 2; ++body)
            for (auto& v : frame.deformed[body])
                for (int axis = 0; axis < 3; ++axis)
                    v[axis] = static_cast<double>(static_cast<float>(
                        v[axis] + 0.9 * body * (axis == 0 ? 1 : 0) + shake.uniform(-0.1, 0.1)));
        return frame;
    };
    return scene;
}

constexpr HardFamily tolerance_table[] = {
    {.row = 11,
     .group = 'b',
     .name = "tolerance-scale",
     .summary = "random near pairs of another size",
     .knob = {"size", 1e-6, 1e6, 1e-3},
     .truth = HardTruth::oracle,
     .metric = "MISS, FPR",
     .fails = "absolute tolerances: at 1e-6 everything overlaps",
     .pair = scaled_pair},
    {.row = 12,
     .group = 'b',
     .name = "tolerance-gap",
     .summary =
         "parallel faces whose distance is the paper's tolerance plus or minus units in the last place",
     .knob = {"units above the tolerance", -64, 64, 1},
     .truth = HardTruth::construction,
     .metric = "false pairs at gap > tolerance",
     .fails = "tolerances added after rounding",
     .pair = gap_near_tolerance},
    {.row = 13,
     .group = 'b',
     .name = "refit-order",
     .summary = "two boxes of tetrahedra with a new deformation in every frame",
     .knob = {"frames", 2, 1000, 8},
     .truth = HardTruth::oracle,
     .metric = "equality with a fresh build",
     .fails = "hierarchies that widen in place",
     .scene = refits}};

} // namespace

std::span<const HardFamily> tolerance_families() { return tolerance_table; }

} // namespace tandem::hard
