// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem {

/// Maximum number of refinement levels, which gives 4096 times the tetrahedra.
constexpr std::uint64_t most_refinement = 4;

/// The mesh after `levels` uniform red refinements (Bey 1995): eight tetrahedra of equal volume replace each
/// tetrahedron in the list. The inner octahedron is cut from the midpoint of corners 0 and 2 to that of 1 and
/// 3, which limits the shapes to three per initial tetrahedron at any level. Vertices keep their numbers;
/// midpoints of edges follow in the order of the edges' ends. `mesh` must be complete, and the result is
/// complete. Throws InputError when 32-bit numbers do not suffice.
Mesh refined(const Mesh& mesh, std::uint64_t levels);

} // namespace tandem
