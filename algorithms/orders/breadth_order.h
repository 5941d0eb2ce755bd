// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <cstdint>
#include <vector>

namespace tandem {

/// Breadth-first order of a mesh's tetrahedra over shared faces, as the paper tried before curves (section
/// 3.1, Figure 5 left): order[i] is the tetrahedron at position i. Each part that is connected by faces
/// starts at its first tetrahedron along the Z-curve. Neighbours follow by number. O(n log n) for any mesh,
/// also if many tetrahedra share a face.
std::vector<std::uint32_t> breadth_order(const Mesh& mesh);

} // namespace tandem
