// SPDX-License-Identifier: MIT
// The bodies of Drake's geometry/benchmarking/compliant_mesh_intersection_benchmark.cc, with meshes of our
// own.
#include "scenes/cubes.h"
#include "scenes/parameters.h"
#include "scenes/pressure_field.h"
#include "scenes/refine.h"

#include <cmath>

namespace tandem {

namespace {

constexpr double modulus = 1e5;        ///< Pa
constexpr double ball_radius = 3;      ///< m
constexpr double cells_times_hint = 8; ///< 2, 3, 4 and 8 cells along a diameter for hints 4, 3, 2 and 1
constexpr double ball_drift = 1e-4;
const Eigen::Vector3d ellipsoid_radii{3.01, 3.5, 4};
/// The ball's distance from the ellipsoid along each axis, by overlap.
constexpr std::array<double, 4> distances = {7, 4, 3.5, 1.2};

Mesh compliant(const std::string& name, const Eigen::Vector3d& radii, std::uint64_t cells,
               std::uint64_t levels) {
    auto mesh = refined(ball_of_cubes(name, radii, cells), levels);
    make_pressures(mesh, modulus);
    return mesh;
}

Scene make_spheres(std::span<const SceneParameter> parameters) {
    Scene scene;
    const double hint = real_parameter(parameters, "hint", 0.05, 4);
    const auto cells = static_cast<std::uint64_t>(std::round(cells_times_hint / hint));
    const double distance = distances[integer_parameter(parameters, "overlap", 0, distances.size() - 1)];
    scene.frame_count = integer_parameter(parameters, "frames", 1, 1000000);
    const auto levels = refine_value(parameters);
    scene.meshes = {compliant("ellipsoid", ellipsoid_radii, cells, levels),
                    compliant("ball", Eigen::Vector3d::Constant(ball_radius), cells, levels)};
    scene.bodies = {Body{.mesh = 0}, Body{.mesh = 1}};
    scene.frame = [distance](std::size_t step) {
        const double drift = ball_drift * distance * static_cast<double>(step);
        Frame frame;
        frame.poses.resize(2);
        frame.poses[1].translation = {distance + drift, distance + 2 * drift, distance + 3 * drift};
        frame.deformed.resize(2);
        return frame;
    };
    return scene;
}

} // namespace

SceneKind spheres_kind() {
    return {"spheres",
            "an ellipsoid and a ball of 3 m with pressure fields of their own, as in Drake's benchmark of "
            "compliant meshes; the ball drifts by a little, no forces",
            {{"hint", "1",
              "about the edges' length as in Drake's benchmark (4, 3, 2 or 1 there), 8/hint cells along a "
              "diameter"},
             {"overlap", "3",
              "0: far apart, 1: only the boxes overlap, 2: a small contact surface, 3: a large one"},
             {"frames", "8", "time steps"},
             refine_parameter()},
            make_spheres};
}

} // namespace tandem
