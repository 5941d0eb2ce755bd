// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem {

/// The chunk over each tetrahedron, numbered from 0, of the tree with the paper's 32 leaves.
std::vector<std::uint32_t> chunk_numbers(const Mesh& mesh);

} // namespace tandem
