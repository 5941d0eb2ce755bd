// SPDX-License-Identifier: MIT
#include "harness/verify/world_vertices.h"

#include "algorithms/bodies/moved_coordinate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tandem {

std::array<double, 3> centre_of(const Mesh& mesh, Origin origin) {
    std::array<double, 3> centre{};
    if (origin == Origin::world) return centre;
    for (int axis = 0; axis < 3; ++axis) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const auto& tetrahedron : mesh.tetrahedra)
            for (const auto vertex : tetrahedron) {
                low = std::min(low, mesh.vertices[vertex][axis]);
                high = std::max(high, mesh.vertices[vertex][axis]);
            }
        const double middle = low + (high - low) / 2;
        if (std::abs(middle) > 8 * (high - low)) centre[axis] = middle;
    }
    return centre;
}

template<class Real>
std::vector<std::array<Real, 3>> world_vertices(const Scene& scene, const Frame& frame, std::size_t body,
                                                Origin origin) {
    const bool deformable = scene.bodies[body].deformable;
    const auto& mesh = scene.meshes[scene.bodies[body].mesh];
    const auto& source = deformable ? frame.deformed[body] : mesh.vertices;
    std::array<std::array<Real, 4>, 3> rows{};
    std::array<double, 3> centre{};
    if (!deformable) {
        centre = centre_of(mesh, origin);
        const bool is_far = centre[0] != 0 || centre[1] != 0 || centre[2] != 0;
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
            const std::array<double, 4> row{matrix[i][0], matrix[i][1], matrix[i][2], pose.translation[i]};
            rows[i][3] = static_cast<Real>(is_far ? moved_coordinate(row, centre) : row[3]);
        }
    }
    std::vector<std::array<Real, 3>> world;
    for (const auto& v : source) {
        const std::array<Real, 3> local{static_cast<Real>(v.x() - centre[0]),
                                        static_cast<Real>(v.y() - centre[1]),
                                        static_cast<Real>(v.z() - centre[2])};
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

template std::vector<std::array<float, 3>> world_vertices<float>(const Scene&, const Frame&, std::size_t,
                                                                 Origin);
template std::vector<std::array<double, 3>> world_vertices<double>(const Scene&, const Frame&, std::size_t,
                                                                   Origin);

} // namespace tandem
