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

} // namespace

double largest_coordinate(Precision precision) { return precision == Precision::fp64 ? 1e306 : 1e36; }

void check_range(const Scene& scene, const Frame& frame, Precision precision) {
    const double limit = largest_coordinate(precision);
    std::vector<double> mesh_sizes;
    for (const auto& mesh : scene.meshes) mesh_sizes.push_back(largest(mesh.vertices));
    for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
        if (scene.bodies[body].deformable) check_finite(frame.deformed[body], body);
        const double size = scene.bodies[body].deformable ? largest(frame.deformed[body])
                                                          : mesh_sizes[scene.bodies[body].mesh];
        const double reach = std::max(size, largest(frame.poses[body].translation));
        if (!(reach <= limit))
            throw InputError(
                fmt::format("body {} has a coordinate of {:g}, and precision={} takes at most {:g}; {}", body,
                            reach, precision == Precision::fp64 ? "double" : "float", limit,
                            precision == Precision::fp64 ? "choose larger units"
                                                         : "use precision=double or larger units"));
    }
}

} // namespace tandem
