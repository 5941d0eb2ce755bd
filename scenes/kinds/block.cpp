// SPDX-License-Identifier: MIT
#include "scenes/assembly.h"
#include "base/random.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr double degree = 0x1.1df46a2529d39p-6; ///< pi / 180

Scene make_block(std::span<const SceneParameter> parameters) {
    Assembly assembly(parameters);
    auto& dynamics = assembly.dynamics;
    const auto bodies = integer_parameter(parameters, "bodies", 1, 100000);
    const double side = real_parameter(parameters, "size", 0.01, 100);
    const double speed = real_parameter(parameters, "speed", -1e4, 1e4);
    const double drop = real_parameter(parameters, "drop", 0, 1e4);
    const bool stack = integer_parameter(parameters, "stack", 0, 1) == 1;
    const Surface surface{real_parameter(parameters, "friction", 0, 1e3),
                          real_parameter(parameters, "restitution", 0, 1)};
    const auto slope = sine_cosine(degree * real_parameter(parameters, "slope", -90, 90));
    dynamics.materials = {.names = {"block", "ground"},
                          .densities = {1000, 1000},
                          .surfaces = {{{0, 0}, surface}, {{0, 1}, surface}}};
    dynamics.gravity = {9.82 * slope.sine, -9.82 * slope.cosine, 0};
    assembly.add_ground(std::max(100.0, 2 * static_cast<double>(bodies)) * side, 1);
    const auto cube = assembly.add_box({side, side, side});
    assembly.check_memory(bodies, cube);
    for (std::uint64_t i = 0; i < bodies; ++i) {
        const auto number = static_cast<double>(i);
        const double y = drop + side * (stack ? number + 0.5 : 0.5);
        const double z = stack ? 0 : 2 * side * (number - 0.5 * static_cast<double>(bodies - 1));
        assembly.add(cube, {.pose = {.translation = {0, y, z}}, .velocity = {speed, 0, 0}});
    }
    return assembly.finish();
}

} // namespace

SceneKind block_kind() {
    return {"block",
            "cubes at rest on the ground, sliding over it, falling on it, in a row or stacked: cases whose "
            "motion "
            "is known; a slope turns gravity, not the ground",
            {{"bodies", "1", "cubes"},
             {"size", "1", "side of a cube, m; the ground is 100 times as wide or more"},
             {"speed", "0", "initial speed along x, m/s"},
             {"drop", "0", "initial height above the ground, m"},
             {"stack", "0", "1 stacks the cubes, 0 puts them in a row across the motion"},
             {"friction", "0.5", "Coulomb's coefficient"},
             {"restitution", "0", "Newton's coefficient"},
             {"slope", "0", "degrees downhill along x"},
             refine_parameter()},
            make_block};
}

} // namespace tandem
