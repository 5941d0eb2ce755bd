// SPDX-License-Identifier: MIT
#include "scenes/hard/solids.h"

namespace tandem::hard {

namespace {

double coordinate(std::uint32_t index, std::uint32_t cells, double size) {
    return static_cast<double>(static_cast<float>(size * (1.0 * index / cells - 0.5)));
}

} // namespace

Mesh grid(const std::array<std::uint32_t, 3>& cells, const Eigen::Vector3d& size) {
    Mesh mesh;
    mesh.name = "grid";
    const std::uint32_t step[3] = {1, cells[0] + 1, (cells[0] + 1) * (cells[1] + 1)};
    for (std::uint32_t z = 0; z <= cells[2]; ++z)
        for (std::uint32_t y = 0; y <= cells[1]; ++y)
            for (std::uint32_t x = 0; x <= cells[0]; ++x)
                mesh.vertices.emplace_back(coordinate(x, cells[0], size.x()),
                                           coordinate(y, cells[1], size.y()),
                                           coordinate(z, cells[2], size.z()));
    constexpr std::uint32_t orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (std::uint32_t cell = 0; cell < cells[0] * cells[1] * cells[2]; ++cell) {
        const auto first =
            cell % cells[0] + cell / cells[0] % cells[1] * step[1] + cell / cells[0] / cells[1] * step[2];
        for (const auto& order : orders) {
            const auto second = first + step[order[0]];
            const auto third = second + step[order[1]];
            mesh.tetrahedra.push_back({first, second, third, third + step[order[2]]});
        }
    }
    complete_mesh(mesh, mesh.name);
    return mesh;
}

Mesh separate(std::string name, const std::vector<FloatCorners>& tetrahedra) {
    Mesh mesh;
    mesh.name = std::move(name);
    for (const auto& corners : tetrahedra) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const auto& c : corners)
            mesh.vertices.emplace_back(static_cast<double>(c[0]), static_cast<double>(c[1]),
                                       static_cast<double>(c[2]));
        mesh.tetrahedra.push_back({first, first + 1, first + 2, first + 3});
    }
    complete_mesh(mesh, mesh.name);
    return mesh;
}

Scene still(std::vector<Mesh> meshes, std::vector<Pose> poses) {
    Scene scene;
    scene.meshes = std::move(meshes);
    for (std::uint32_t i = 0; i < poses.size(); ++i)
        scene.bodies.push_back({.mesh = i % static_cast<std::uint32_t>(scene.meshes.size())});
    scene.frame = [poses = std::move(poses)](std::size_t) {
        return Frame{poses, std::vector<std::vector<Eigen::Vector3d>>(poses.size())};
    };
    return scene;
}

Pose at(const Eigen::Vector3d& translation) {
    Pose pose;
    for (int axis = 0; axis < 3; ++axis)
        pose.translation[axis] = static_cast<double>(static_cast<float>(translation[axis]));
    return pose;
}

} // namespace tandem::hard
