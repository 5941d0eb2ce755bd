// SPDX-License-Identifier: MIT
#include "algorithms/bodies/check_input.h"

#include "algorithms/bodies/range.h"
#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>

namespace tandem {

namespace {

/// Areas and pressures that are too small for the precision would lose digits.
void check_surface(const Mesh& mesh, std::size_t number, Precision precision) {
    Eigen::AlignedBox3d box;
    for (const auto& tetrahedron : mesh.tetrahedra)
        for (const auto vertex : tetrahedron) box.extend(mesh.vertices[vertex]);
    const char* remedy = precision == Precision::fp64 ? "" : " or precision=double";
    const double extent = box.sizes().maxCoeff(), least = smallest_extent(precision);
    if (!(extent >= least))
        throw InputError(fmt::format("mesh {} is {:g} wide, and areas of surfaces need at least {:g} in this "
                                     "precision; use smaller units{}",
                                     number, extent, least, remedy));
    const double pressure = mesh.pressures.empty() ? 0 : std::ranges::max(mesh.pressures);
    if (pressure > 0 && pressure < smallest_pressure(precision))
        throw InputError(
            fmt::format("mesh {} has pressures up to {:g}, and this precision needs at least {:g}; use "
                        "smaller units{}",
                        number, pressure, smallest_pressure(precision), remedy));
}

void check_mesh(const Mesh& mesh, std::size_t number, const Geometry& geometry) {
    if (mesh.tetrahedra.empty())
        throw InputError(fmt::format("mesh {} has no tetrahedra; a body needs at least one", number));
    if (mesh.boundary.size() != mesh.tetrahedra.size())
        throw InputError(fmt::format("mesh {} has {} boundary flags for {} tetrahedra; call complete_mesh",
                                     number, mesh.boundary.size(), mesh.tetrahedra.size()));
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (const auto vertex : mesh.tetrahedra[t])
            if (vertex >= mesh.vertices.size())
                throw InputError(
                    fmt::format("mesh {}: tetrahedron {} has vertex {} of {}; call complete_mesh", number, t,
                                vertex, mesh.vertices.size()));
    const double limit = largest_coordinate(geometry);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        if (!(mesh.vertices[v].array().abs() <= limit).all()) // also NaN
            throw InputError(fmt::format(
                "mesh {}: vertex {} has a coordinate that is not finite or exceeds {:g}, "
                "the most of this precision; use larger units{}",
                number, v, limit, geometry.precision == Precision::fp64 ? "" : " or precision=double"));
    if (geometry.pressures) check_surface(mesh, number, geometry.precision);
}

/// The squared length of a product of rounded rotations stays within it by orders of magnitude.
bool is_rotation(const Eigen::Quaterniond& rotation) {
    constexpr double tolerance = 2e-3;
    return std::abs(rotation.squaredNorm() - 1) <= tolerance; // false for NaN
}

void check_state(const Scene& scene, const Frame& frame, const Geometry& geometry, std::size_t body) {
    const auto& mesh = scene.meshes[scene.bodies[body].mesh];
    if (!scene.bodies[body].deformable) {
        if (!is_rotation(frame.poses[body].rotation))
            throw InputError(
                fmt::format("body {} has a rotation of length {:g}; give a quaternion of length 1", body,
                            frame.poses[body].rotation.norm()));
    } else if (frame.deformed[body].size() != mesh.vertices.size()) {
        throw InputError(fmt::format("body {} is deformable and has {} vertices in the frame and {} in its "
                                     "mesh; give one position a vertex",
                                     body, frame.deformed[body].size(), mesh.vertices.size()));
    }
    check_range_of(scene, frame, geometry, body);
    if (frame.skipped.empty()) return;
    const auto& skipped = frame.skipped[body];
    const bool is_ascending = std::ranges::adjacent_find(skipped, std::greater_equal<>()) == skipped.end();
    if (!is_ascending || (!skipped.empty() && skipped.back() >= mesh.tetrahedra.size()))
        throw InputError(fmt::format("body {}: skipped tetrahedra must be ascending and below {}", body,
                                     mesh.tetrahedra.size()));
}

void check_lists(const Scene& scene, const Frame& frame) {
    const auto bodies = scene.bodies.size();
    const auto expect = [bodies](std::size_t count, const char* what) {
        if (count != bodies)
            throw InputError(
                fmt::format("the frame has {} {} for {} bodies; give one a body", count, what, bodies));
    };
    expect(frame.poses.size(), "poses");
    expect(frame.deformed.size(), "lists of vertices (empty ones for rigid bodies)");
    if (!frame.skipped.empty()) expect(frame.skipped.size(), "lists of skipped tetrahedra");
}

} // namespace

void check_scene(const Scene& scene, const Geometry& geometry) {
    std::vector<bool> is_used(scene.meshes.size());
    for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
        const auto mesh = scene.bodies[body].mesh;
        if (mesh >= scene.meshes.size())
            throw InputError(fmt::format("body {} has mesh {}, and the scene has {} meshes", body, mesh,
                                         scene.meshes.size()));
        is_used[mesh] = true;
    }
    for (std::size_t mesh = 0; mesh < scene.meshes.size(); ++mesh)
        if (is_used[mesh]) check_mesh(scene.meshes[mesh], mesh, geometry);
    if (scene.world_size != 0 && scene.numbers.empty() && scene.bodies.size() % scene.world_size != 0)
        throw InputError(fmt::format("Scene::world_size is {}, which does not divide {} bodies",
                                     scene.world_size, scene.bodies.size()));
    if (!std::ranges::is_sorted(scene.never_meet)) throw InputError("Scene::never_meet must be ascending");
    for (const auto& [a, b] : scene.never_meet)
        if (a > b || b >= scene.bodies.size())
            throw InputError(fmt::format("Scene::never_meet has the pair {}, {}; give a <= b below {}", a, b,
                                         scene.bodies.size()));
}

void check_frame(const Scene& scene, const Frame& frame, const Geometry& geometry,
                 std::optional<std::span<const std::uint32_t>> owned) {
    check_lists(scene, frame);
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body)
        if (!owned || scene.bodies[body].fixed) check_state(scene, frame, geometry, body);
    if (!owned) return;
    for (const auto body : *owned) check_state(scene, frame, geometry, body);
}

} // namespace tandem
