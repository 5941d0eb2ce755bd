// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <cstdint>
#include <vector>

namespace tandem {

/// Order of a mesh's tetrahedra by recursive halving: order[i] is the tetrahedron at position i. A range is
/// cut across the longest side of its centroids' box, at the multiple of its run length (run_of) nearest to
/// the middle. Runs of 32, 32^2, ... are thus full, and the nodes of a perfect tree are the halves. In ranges
/// of up to 32 the right half may be shorter. Ties go to the lower axis, the upper position and the lower
/// number. O(n log n).
std::vector<std::uint32_t> median_order(const Mesh& mesh);

} // namespace tandem
