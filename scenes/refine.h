// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem {

/// Most levels of refinement that a scene takes: 4096 times the tetrahedra.
constexpr std::uint64_t most_refinement = 4;

/// The mesh after `levels` uniform red refinements (Bey 1995): every tetrahedron becomes eight of equal
/// volume, in place of their parent; the octahedron inside is cut along the edge from the middle of corners 0
/// and 2 to that of 1 and 3, so that however often it is done there are at most three shapes to a tetrahedron
/// of the start. Vertices keep their numbers, middles of edges follow in the order of the edges' ends.
/// `mesh` must be complete; so is the result. Throws InputError where 32-bit numbers would not do.
Mesh refined(const Mesh& mesh, std::uint64_t levels);

} // namespace tandem
