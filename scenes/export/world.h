// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

namespace tandem::exporting {

/// The vertices of a body in world coordinates.
std::vector<Eigen::Vector3d> world_vertices(const Scene& scene, const Frame& frame, std::size_t body);

/// The boundary of a mesh as triangles, counterclockwise from outside.
struct BoundarySurface {
    std::vector<std::uint32_t> vertices;   ///< mesh vertices on the boundary, ascending
    std::vector<std::uint32_t> triangles;  ///< three indices into `vertices` each
    std::vector<std::uint32_t> tetrahedra; ///< one a triangle: its tetrahedron
};

BoundarySurface surface_of(const Mesh& mesh);

/// Coordinates x, y, z of a surface's vertices. `vertices` are the vertices of the mesh.
std::vector<float> points_of(const BoundarySurface& surface, const std::vector<Eigen::Vector3d>& vertices);

/// Creates or replaces a file; throws InputError.
void write_file(const std::string& path, std::string_view bytes);

} // namespace tandem::exporting
