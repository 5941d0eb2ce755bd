// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <cstdint>
#include <vector>

namespace tandem {

/// Order of a mesh's tetrahedra whose runs of 32, 32^2, ... have small boxes: order[i] is the tetrahedron at
/// position i. Ranges are cut recursively at a multiple of the run length (run_of), along one axis. The cut
/// minimises the surface area heuristic (MacDonald and Booth 1990: area of each box times its number of
/// items). Runs of up to 32 are halved. Ties go to the lower axis, position and number, so that a mesh has
/// one order. O(n log n) and, for the worst meshes, 31 n for each run length.
std::vector<std::uint32_t> sah_order(const Mesh& mesh);

/// The same for one complete binary tree over the whole mesh (heap.clh): each node's range is cut where the
/// tree's left half ends, along the axis with the smallest cost of the surface area heuristic. O(n log n).
std::vector<std::uint32_t> balanced_order(const Mesh& mesh);

} // namespace tandem
