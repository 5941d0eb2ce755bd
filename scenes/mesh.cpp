// SPDX-License-Identifier: MIT
#include "scenes/mesh.h"

#include "base/error.h"
#include "scenes/faces.h"

#include <cmath>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Six times the signed volume, in a fixed order of operations.
double determinant(const Mesh& mesh, const Tetrahedron& t) {
    const Eigen::Vector3d a = mesh.vertices[t[1]] - mesh.vertices[t[0]];
    const Eigen::Vector3d b = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    const Eigen::Vector3d c = mesh.vertices[t[3]] - mesh.vertices[t[0]];
    return (a.x() * (b.y() * c.z() - b.z() * c.y()) - a.y() * (b.x() * c.z() - b.z() * c.x()))
           + a.z() * (b.x() * c.y() - b.y() * c.x());
}

/// A face of only one tetrahedron is on the boundary.
void flag_boundary(Mesh& mesh) {
    mesh.boundary.assign(mesh.tetrahedra.size(), 0);
    const auto faces = sorted_faces(mesh);
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const bool before = i > 0 && faces[i - 1].vertices == faces[i].vertices;
        const bool after = i + 1 < faces.size() && faces[i + 1].vertices == faces[i].vertices;
        if (!before && !after)
            mesh.boundary[faces[i].tetrahedron] |= static_cast<std::uint8_t>(1u << faces[i].corner);
    }
}

} // namespace

void complete_mesh(Mesh& mesh, const std::string& source) {
    if (mesh.tetrahedra.empty())
        throw InputError(fmt::format("{}: no tetrahedra; give a volume mesh", source));
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        if (!mesh.vertices[v].allFinite())
            throw InputError(fmt::format("{}: vertex {} is not finite; repair the mesh", source, v));
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (const auto vertex : mesh.tetrahedra[t])
            if (vertex >= mesh.vertices.size())
                throw InputError(fmt::format("{}: tetrahedron {} names vertex {} of {}; repair the mesh",
                                             source, t, vertex, mesh.vertices.size()));
    count_flawed(mesh);
    flag_boundary(mesh);
}

void count_flawed(Mesh& mesh) {
    mesh.inverted = mesh.degenerate = 0;
    for (const auto& t : mesh.tetrahedra) {
        const double det = determinant(mesh, t);
        mesh.inverted += det < 0 ? 1 : 0;
        mesh.degenerate += det == 0 ? 1 : 0;
    }
}

double volume(const Mesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.tetrahedra) sum += std::abs(determinant(mesh, t));
    return sum / 6;
}

} // namespace tandem
