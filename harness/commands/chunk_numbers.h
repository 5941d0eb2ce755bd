// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem {

/// The chunk number of each tetrahedron, from 0. Chunks have 32 leaves, as in the paper, in Morton order.
std::vector<std::uint32_t> chunk_numbers(const Mesh& mesh);

} // namespace tandem
