// SPDX-License-Identifier: MIT
#include "scenes/cubes.h"

#include "base/memory.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tandem {

namespace {

void refuse_large(const std::string& name, const CubeCounts& counts) {
    const auto count = static_cast<double>(counts[0] * counts[1] * counts[2]);
    refuse_beyond_memory(fmt::format("the tetrahedra of mesh {}", name),
                         count * (6 * sizeof(Tetrahedron) + sizeof(Eigen::Vector3d)));
}

} // namespace

Mesh cubes(const std::string& name, const CubeCounts& counts) {
    refuse_large(name, counts);
    Mesh mesh;
    mesh.name = name;
    const auto [length, height, width] = counts;
    for (std::uint64_t z = 0; z <= width; ++z)
        for (std::uint64_t y = 0; y <= height; ++y)
            for (std::uint64_t x = 0; x <= length; ++x)
                mesh.vertices.emplace_back(static_cast<double>(x), static_cast<double>(y),
                                           static_cast<double>(z));
    const CubeCounts next{1, length + 1, (length + 1) * (height + 1)};
    for (std::uint64_t cube = 0; cube < length * height * width; ++cube) {
        const auto first =
            cube % length + cube / length % height * next[1] + cube / (length * height) * next[2];
        for (const auto& corners : tetrahedra_of_cube) {
            auto& tetrahedron = mesh.tetrahedra.emplace_back();
            for (std::size_t i = 0; i < 4; ++i)
                tetrahedron[i] = static_cast<std::uint32_t>(first + (corners[i] & 1) * next[0]
                                                            + (corners[i] >> 1 & 1) * next[1]
                                                            + (corners[i] >> 2) * next[2]);
        }
    }
    return mesh;
}

Mesh box_of_cubes(const std::string& name, const Eigen::Vector3d& size, const CubeCounts& counts) {
    auto mesh = cubes(name, counts);
    for (auto& v : mesh.vertices)
        for (int axis = 0; axis < 3; ++axis) {
            const auto count = static_cast<double>(counts[static_cast<std::size_t>(axis)]);
            v[axis] = size[axis] * ((2 * v[axis] - count) / (2 * count));
        }
    complete_mesh(mesh, name);
    return mesh;
}

Mesh ball_of_cubes(const std::string& name, const Eigen::Vector3d& radii, std::uint64_t cells) {
    auto mesh = cubes(name, {cells, cells, cells});
    const auto edge = static_cast<double>(cells);
    for (auto& v : mesh.vertices) {
        const double x = 2 * v.x() - edge, y = 2 * v.y() - edge, z = 2 * v.z() - edge; // exact
        const double shell = std::max({std::abs(x), std::abs(y), std::abs(z)}) / edge;
        const double length = std::sqrt((x * x + y * y) + z * z);
        const double factor = length > 0 ? shell / length : 0;
        v = {radii.x() * (factor * x), radii.y() * (factor * y), radii.z() * (factor * z)};
    }
    complete_mesh(mesh, name);
    return mesh;
}

} // namespace tandem
