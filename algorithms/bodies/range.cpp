// SPDX-License-Identifier: MIT
#include "algorithms/bodies/range.h"

#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace tandem {

namespace {

/// Infinite if a coordinate is NaN, because a maximum would ignore NaN.
double largest(const Eigen::Vector3d& point) {
    return point.hasNaN() ? std::numeric_limits<double>::infinity() : point.lpNorm<Eigen::Infinity>();
}

double largest(const std::vector<Eigen::Vector3d>& points) {
    double size = 0;
    for (const auto& p : points) size = std::max(size, largest(p));
    return size;
}

/// Throws InputError that names the first vertex with a coordinate that is not finite.
void check_finite(const std::vector<Eigen::Vector3d>& vertices, std::size_t body) {
    for (std::size_t v = 0; v < vertices.size(); ++v)
        if (!vertices[v].allFinite())
            throw InputError(fmt::format("body {}: vertex {} is not finite; repair the frame", body, v));
}

/// `mesh_size`: largest coordinate of the mesh of a rigid body.
void check_body(const Scene& scene, const Frame& frame, const Geometry& geometry, std::size_t body,
                double mesh_size) {
    const bool is_deformable = scene.bodies[body].deformable;
    if (is_deformable) check_finite(frame.deformed[body], body);
    if (!frame.poses[body].translation.allFinite())
        throw InputError(fmt::format("body {} has a position that is not finite; repair the frame", body));
    const double size = is_deformable ? largest(frame.deformed[body]) : mesh_size;
    const double reach = std::max(size, largest(frame.poses[body].translation));
    const double limit = largest_coordinate(geometry);
    if (reach <= limit) return;
    const bool is_double = geometry.precision == Precision::fp64;
    throw InputError(fmt::format(
        "body {} has a coordinate of {:g}, and precision={} takes at most {:g}{}; {}", body, reach,
        is_double ? "double" : "float", limit, geometry.pressures ? " where surfaces have areas" : "",
        is_double ? "choose larger units" : "use precision=double or larger units"));
}

} // namespace

double largest_coordinate(const Geometry& geometry) {
    if (geometry.precision == Precision::fp64) return geometry.pressures ? 1e153 : 1e306;
    return geometry.pressures ? 1e18 : 1e36;
}

double smallest_pressure(Precision precision) { return precision == Precision::fp64 ? 1e-290 : 1e-30; }

double smallest_extent(Precision precision) { return precision == Precision::fp64 ? 1e-140 : 1e-12; }

void check_range(const Scene& scene, const Frame& frame, const Geometry& geometry) {
    std::vector<double> mesh_sizes;
    for (const auto& mesh : scene.meshes) mesh_sizes.push_back(largest(mesh.vertices));
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        check_body(scene, frame, geometry, body, mesh_sizes[scene.bodies[body].mesh]);
}

void check_range_of(const Scene& scene, const Frame& frame, const Geometry& geometry, std::size_t body) {
    check_body(scene, frame, geometry, body, 0);
}

} // namespace tandem
