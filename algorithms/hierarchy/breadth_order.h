// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <cstdint>
#include <vector>

namespace tandem {

/// Tetrahedra of a mesh breadth-first over those that share a face, as the paper tried before curves (section
/// 3.1, Figure 5 left): position i holds the tetrahedron order[i]. It begins at the first along the Z-curve,
/// as does each further part of the mesh that shares no face with those before; neighbours follow by number.
/// O(n log n) for any mesh, faces of many tetrahedra included.
std::vector<std::uint32_t> breadth_order(const Mesh& mesh);

} // namespace tandem
