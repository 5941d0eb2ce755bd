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
void check_body(const Scene& scene, const Frame& frame, Precision precision, std::size_t body,
                double mesh_size) {
    const bool is_deformable = scene.bodies[body].deformable;
    if (is_deformable) check_finite(frame.deformed[body], body);
    if (!frame.poses[body].translation.allFinite())
        throw InputError(fmt::format("body {} has a position that is not finite; repair the frame", body));
    const double size = is_deformable ? largest(frame.deformed[body]) : mesh_size;
    const double reach = std::max(size, largest(frame.poses[body].translation));
    const double limit = largest_coordinate(precision);
    if (reach <= limit) return;
    const bool is_double = precision == Precision::fp64;
    throw InputError(fmt::format("body {} has a coordinate of {:g}, and precision={} takes at most {:g}; {}",
                                 body, reach, is_double ? "double" : "float", limit,
                                 is_double ? "choose larger units" : "use precision=double or larger units"));
}

} // namespace

double largest_coordinate(Precision precision) { return precision == Precision::fp64 ? 1e306 : 1e36; }

void check_range(const Scene& scene, const Frame& frame, Precision precision) {
    std::vector<double> mesh_sizes;
    for (const auto& mesh : scene.meshes) mesh_sizes.push_back(largest(mesh.vertices));
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        check_body(scene, frame, precision, body, mesh_sizes[scene.bodies[body].mesh]);
}

void check_range_of(const Scene& scene, const Frame& frame, Precision precision, std::size_t body) {
    check_body(scene, frame, precision, body, 0);
}

} // namespace tandem
