// SPDX-License-Identifier: MIT
#include "harness/verify/world_vertices.h"

#include "algorithms/bodies/moved_coordinate.h"

#include <cmath>

namespace tandem {

template<class Real>
std::vector<std::array<Real, 3>> world_vertices(const Scene& scene, const Frame& frame, std::size_t body) {
    const bool deformable = scene.bodies[body].deformable;
    const auto& source = deformable ? frame.deformed[body] : scene.meshes[scene.bodies[body].mesh].vertices;
    std::array<std::array<Real, 4>, 3> rows{};
    if (!deformable) {
        const auto& pose = frame.poses[body];
        const auto& p = pose.rotation;
        // The order of additions must be that of algorithms/bodies, so that all bits are equal.
        const double norm = std::sqrt((p.w() * p.w() + p.x() * p.x()) + (p.y() * p.y() + p.z() * p.z()));
        const double w = p.w() / norm, x = p.x() / norm, y = p.y() / norm, z = p.z() / norm;
        const double matrix[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                                     {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                                     {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) rows[i][j] = static_cast<Real>(matrix[i][j]);
            rows[i][3] = static_cast<Real>(pose.translation[i]);
        }
    }
    std::vector<std::array<Real, 3>> world;
    for (const auto& v : source) {
        const std::array<Real, 3> local{static_cast<Real>(v.x()), static_cast<Real>(v.y()),
                                        static_cast<Real>(v.z())};
        if (deformable) {
            world.push_back(local);
            continue;
        }
        std::array<Real, 3> moved{};
        for (int i = 0; i < 3; ++i) moved[i] = moved_coordinate(rows[i], local);
        world.push_back(moved);
    }
    return world;
}

template std::vector<std::array<float, 3>> world_vertices<float>(const Scene&, const Frame&, std::size_t);
template std::vector<std::array<double, 3>> world_vertices<double>(const Scene&, const Frame&, std::size_t);

} // namespace tandem
