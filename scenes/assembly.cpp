// SPDX-License-Identifier: MIT
#include "scenes/assembly.h"

#include "base/random.h"
#include "scenes/refine.h"
#include "scenes/shapes.h"

#include <algorithm>

namespace tandem {

StepSettings measured_stepping() {
    return {.post_stabilize = false,
            .bound_energy = false,
            .surface_normals = false,
            .contact_layer = 0,
            .linear_damping = 0.01,
            .angular_damping = 0.01};
}

SolverSettings measured_solver() { return {.iterations = 150, .absolute_tolerance = 0.01}; }

Dynamics masonry::dynamics() {
    constexpr Surface stones{0.65, 0.7};
    constexpr Surface stone_ground{0.75, 0.3};
    constexpr Surface stone_ball{0.45, 0.8};
    constexpr Surface ball_ground{0.45, 0.3};
    constexpr Surface balls{0.3, 0.9};
    Dynamics result;
    // The ground is always fixed, so that the pair ground-ground needs no surface.
    result.materials = {.names = {"stone", "ground", "cannonball"},
                        .densities = {2000, 5500, 7900},
                        .surfaces = {{{0, 0}, stones},
                                     {{0, 1}, stone_ground},
                                     {{0, 2}, stone_ball},
                                     {{1, 2}, ball_ground},
                                     {{2, 2}, balls}}};
    result.stepping = measured_stepping();
    result.solver = measured_solver();
    return result;
}

Assembly::Assembly(std::span<const SceneParameter> parameters) : refine_(refine_value(parameters)) {}

std::uint32_t Assembly::add_mesh(const Mesh& mesh) {
    scene_.meshes.push_back(refined(mesh, refine_));
    return static_cast<std::uint32_t>(scene_.meshes.size() - 1);
}

std::uint32_t Assembly::add_box(const Eigen::Vector3d& exact) {
    const Eigen::Vector3d size = exact.unaryExpr(&halved_on_grid);
    const auto known =
        std::find_if(boxes_.begin(), boxes_.end(), [&](const auto& b) { return b.first == size; });
    if (known != boxes_.end()) return known->second;
    boxes_.emplace_back(size, add_mesh(box(size)));
    return boxes_.back().second;
}

void Assembly::add(std::uint32_t mesh, const BodyPlacement& placement) {
    scene_.bodies.push_back({.mesh = mesh, .fixed = placement.fixed, .deformable = false});
    start_.poses.push_back(placement.pose);
    start_.deformed.emplace_back();
    dynamics.bodies.push_back({.material = placement.material, .velocity = placement.velocity});
}

void Assembly::add_deformable(std::uint32_t mesh, double turn, const Eigen::Vector3d& translation,
                              std::int32_t elastic) {
    scene_.bodies.push_back({.mesh = mesh, .fixed = false, .deformable = true});
    start_.poses.emplace_back();
    dynamics.bodies.push_back({.elastic = elastic});
    const auto [sine, cosine] = sine_cosine(turn);
    auto& vertices = start_.deformed.emplace_back();
    // The rotation leaves heights unchanged, so that stacked bodies touch exactly.
    for (const auto& p : scene_.meshes[mesh].vertices)
        vertices.emplace_back((cosine * p.x() + sine * p.z()) + translation.x(), p.y() + translation.y(),
                              (cosine * p.z() - sine * p.x()) + translation.z());
}

void Assembly::add_ground(double width, std::uint32_t material) {
    add(add_box({width, 1, width}),
        {.pose = {.translation = {0, -0.5, 0}}, .material = material, .fixed = true});
}

Scene Assembly::finish() {
    scene_.frame_count = 1;
    scene_.frame = [start = std::move(start_)](std::size_t) { return start; };
    scene_.dynamics = std::make_shared<const Dynamics>(std::move(dynamics));
    return std::move(scene_);
}

std::vector<Eigen::Vector3d> block(std::size_t bodies, double pitch, double bottom) {
    std::size_t side = 1;
    while (side < 10 && 2 * side * side * side < bodies) ++side;
    const double middle = 0.5 * static_cast<double>(side - 1);
    std::vector<Eigen::Vector3d> centres;
    for (std::size_t i = 0; i < bodies; ++i) {
        const std::size_t layer = i / (side * side);
        const std::size_t row = i / side % side;
        centres.emplace_back(pitch * (static_cast<double>(i % side) - middle),
                             bottom + pitch * (static_cast<double>(layer) + 0.5),
                             pitch * (static_cast<double>(row) - middle));
    }
    return centres;
}

} // namespace tandem
