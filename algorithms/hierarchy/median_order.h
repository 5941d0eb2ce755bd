// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <cstdint>
#include <vector>

namespace tandem {

/// Tetrahedra of a mesh in halves, quarters, ...: position i holds the tetrahedron order[i]. A range is cut
/// across the longest side of its centroids' box at the multiple of its run's length (run_of) that is nearest
/// to the middle, so that runs of 32, 32^2, ... are whole and a perfect tree's nodes are the halves; 32 and
/// fewer leave the right half short. Ties go to the lower axis, the upper place and the lower number. O(n log
/// n).
std::vector<std::uint32_t> median_order(const Mesh& mesh);

} // namespace tandem
