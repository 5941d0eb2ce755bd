// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

namespace tandem::exporting {

/// The vertices of a body in world coordinates.
std::vector<Eigen::Vector3d> world_vertices(const Scene& scene, const Frame& frame, std::size_t body);

/// The boundary of a mesh as triangles that wind counterclockwise seen from outside.
struct Surface {
    std::vector<std::uint32_t> vertices;   ///< mesh vertices that the boundary has, ascending
    std::vector<std::uint32_t> triangles;  ///< three indices into `vertices` each
    std::vector<std::uint32_t> tetrahedra; ///< that each triangle is a face of
};

Surface surface_of(const Mesh& mesh);

/// x, y, z of a surface's vertices, where `vertices` are those of its mesh.
std::vector<float> points_of(const Surface& surface, const std::vector<Eigen::Vector3d>& vertices);

/// Makes or replaces a file; throws InputError.
void write_file(const std::string& path, std::string_view bytes);

} // namespace tandem::exporting
