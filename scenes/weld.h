// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <span>

namespace tandem {

/// By vertex, the smallest number among the vertices that are within `tolerance` of it, directly or along a
/// chain. `tolerance` is finite and not negative; 0 joins equal positions. Positions must be finite. Takes
/// time of order n log n for vertices of a mesh and any tolerance.
std::vector<std::uint32_t> welded_vertices(std::span<const Eigen::Vector3d> positions, double tolerance);

/// Number of vertices of tetrahedra at exactly the position of another one with a smaller number. Takes
/// linear time.
std::size_t count_coincident(const Mesh& mesh);

} // namespace tandem
