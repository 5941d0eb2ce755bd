// SPDX-License-Identifier: MIT
#include "algorithms/kdop/range.h"

#include "scenes/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

double largest(const std::vector<Eigen::Vector3d>& points) {
    double size = 0;
    for (const auto& p : points) size = std::max(size, p.lpNorm<Eigen::Infinity>());
    return size;
}

} // namespace

double largest_coordinate(Precision precision) { return precision == Precision::twice ? 1e306 : 1e36; }

void check_range(const Scene& scene, const Frame& frame, Precision precision) {
    const double limit = largest_coordinate(precision);
    std::vector<double> mesh_sizes;
    for (const auto& mesh : scene.meshes) mesh_sizes.push_back(largest(mesh.vertices));
    for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
        const double size = scene.bodies[body].deformable ? largest(frame.deformed[body])
                                                          : mesh_sizes[scene.bodies[body].mesh];
        const double reach = std::max(size, frame.poses[body].translation.lpNorm<Eigen::Infinity>());
        if (!(reach <= limit))
            throw InputError(
                fmt::format("body {} has a coordinate of {:g}, and precision={} takes at most {:g}; {}", body,
                            reach, precision == Precision::twice ? "double" : "float", limit,
                            precision == Precision::twice ? "choose larger units"
                                                          : "use precision=double or larger units"));
    }
}

} // namespace tandem
