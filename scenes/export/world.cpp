// SPDX-License-Identifier: MIT
#include "scenes/export/world.h"

#include "scenes/motion.h"
#include "scenes/recording/file.h"

#include <algorithm>

namespace tandem::exporting {

namespace {

/// The face opposite each corner, oriented outward when the volume is positive.
constexpr std::array<std::array<std::uint8_t, 3>, 4> faces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

bool inverted(const Mesh& mesh, const Tetrahedron& t) {
    const auto edge = [&](std::size_t i) -> Eigen::Vector3d {
        return mesh.vertices[t[i]] - mesh.vertices[t[0]];
    };
    return edge(1).cross(edge(2)).dot(edge(3)) < 0;
}

} // namespace

std::vector<Eigen::Vector3d> world_vertices(const Scene& scene, const Frame& frame, std::size_t body) {
    if (scene.bodies[body].deformable) return frame.deformed[body];
    auto vertices = scene.meshes[scene.bodies[body].mesh].vertices;
    const auto& pose = frame.poses[body];
    for (auto& v : vertices) v = rotated(pose.rotation, v) + pose.translation;
    return vertices;
}

/// Faces are outward also for inverted tetrahedra. Vertices off the boundary are left out, the rest
/// renumbered.
BoundarySurface surface_of(const Mesh& mesh) {
    BoundarySurface surface;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const auto& corners = mesh.tetrahedra[t];
        const bool flip = inverted(mesh, corners);
        for (std::size_t f = 0; f < faces.size(); ++f) {
            if ((mesh.boundary[t] >> f & 1u) == 0) continue;
            auto face = faces[f];
            if (flip) std::swap(face[1], face[2]);
            for (const auto corner : face) surface.triangles.push_back(corners[corner]);
            surface.tetrahedra.push_back(static_cast<std::uint32_t>(t));
        }
    }
    surface.vertices = surface.triangles;
    std::sort(surface.vertices.begin(), surface.vertices.end());
    surface.vertices.erase(std::unique(surface.vertices.begin(), surface.vertices.end()),
                           surface.vertices.end());
    for (auto& vertex : surface.triangles)
        vertex = static_cast<std::uint32_t>(
            std::lower_bound(surface.vertices.begin(), surface.vertices.end(), vertex)
            - surface.vertices.begin());
    return surface;
}

std::vector<float> points_of(const BoundarySurface& surface, const std::vector<Eigen::Vector3d>& vertices) {
    std::vector<float> points;
    points.reserve(surface.vertices.size() * 3);
    for (const auto vertex : surface.vertices)
        for (const double x : vertices[vertex]) points.push_back(static_cast<float>(x));
    return points;
}

void write_file(const std::string& path, std::string_view bytes) {
    recording::RecordingFile(path, recording::RecordingFile::Mode::replace).write(0, bytes);
}

} // namespace tandem::exporting
