// SPDX-License-Identifier: MIT
#include "scenes/assembly.h"
#include "scenes/builtin.h"
#include "base/random.h"

#include <fmt/format.h>

namespace tandem {

namespace {

constexpr std::size_t shapes = 6;   ///< grain1 to grain6
constexpr double grain_pitch = 1.1; ///< m; a grain is less than 1 m across in every direction
constexpr double wall = 0.5;        ///< thickness, m
enum : std::uint32_t { grain, steel };

/// Sets the paper's configuration, with small steps and correction of positions.
void set_solver(Dynamics& dynamics) {
    constexpr Surface rough{0.65, 0};
    dynamics.materials = {
        .names = {"grain", "steel"},
        .densities = {10, 7900},
        .surfaces = {{{grain, grain}, rough}, {{grain, steel}, rough}, {{steel, steel}, rough}}};
    dynamics.gravity = {0, -10, 0};
    dynamics.stepping = {.step = 0.001,
                         .pre_stabilize = true,
                         .post_stabilize = true,
                         .bounce = false,
                         .bound_energy = false,
                         .surface_normals = false,
                         .contact_layer = 0,
                         .linear_damping = 0.001,
                         .angular_damping = 0.001};
    dynamics.solver = {.iterations = 1000, .absolute_tolerance = 1e-5};
    dynamics.steps = 3000;
}

/// Adds a square floor, its top at y = 0, with four walls on it.
void add_box_of_walls(Assembly& assembly, double width, double height) {
    const auto fixed = [](double x, double y, double z) {
        return BodyPlacement{.pose = {.translation = {x, y, z}}, .material = steel, .fixed = true};
    };
    const double offset = 0.5 * (width + wall);
    assembly.add(assembly.add_box({width + 2 * wall, wall, width + 2 * wall}), fixed(0, -0.5 * wall, 0));
    const auto along_z = assembly.add_box({wall, height, width + 2 * wall});
    const auto along_x = assembly.add_box({width, height, wall});
    for (const double side : {1.0, -1.0}) {
        assembly.add(along_z, fixed(side * offset, 0.5 * height, 0));
        assembly.add(along_x, fixed(0, 0.5 * height, side * offset));
    }
}

Scene make_chalk(std::span<const SceneParameter> parameters) {
    Assembly assembly(parameters);
    set_solver(assembly.dynamics);
    const auto bodies = integer_parameter(parameters, "bodies", 1, 100000);
    Random random(integer_parameter(parameters, "seed", 0, ~std::uint64_t{0}));
    std::size_t side = 1;
    while (side * side * side < bodies) ++side;
    const double width = grain_pitch * static_cast<double>(side);
    const std::size_t layers = (bodies + side * side - 1) / (side * side);
    const double filled = grain_pitch * static_cast<double>(layers);
    add_box_of_walls(assembly, width, filled + 3 * wall);
    std::vector<std::uint32_t> grains;
    for (std::size_t i = 1; i <= shapes; ++i)
        grains.push_back(assembly.add_mesh(built_in_mesh(fmt::format("grain{}", i))));
    assembly.check_memory(bodies, grains.front());
    const auto position = [&](std::size_t n) { return grain_pitch * (static_cast<double>(n) + 0.5); };
    for (std::size_t i = 0; i < bodies; ++i) {
        const std::size_t layer = i / (side * side);
        const Eigen::Vector3d centre(position(i % side) - 0.5 * width, position(layer),
                                     position(i / side % side) - 0.5 * width);
        assembly.add(grains[i % shapes], {.pose = {random.rotation(), centre}, .material = grain});
    }
    assembly.add(assembly.add_box({width - 0.1, wall, width - 0.1}),
                 {.pose = {.translation = {0, filled + 0.5 * wall, 0}}, .material = steel});
    return assembly.finish();
}

} // namespace

SceneKind chalk_kind() {
    return {
        "chalk",
        "the paper's Fig. 2, bottom: convex grains in a box under a heavy lid; grains are rigid and do not "
        "crush, six shapes replace scanned ones",
        {{"bodies", "15", "grains, without the five walls and the lid"},
         {"seed", "1", "seed of the orientations"},
         refine_parameter()},
        make_chalk};
}

} // namespace tandem
