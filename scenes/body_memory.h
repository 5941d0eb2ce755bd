// SPDX-License-Identifier: MIT
#pragma once

#include "base/memory.h"
#include "scenes/mesh.h"

namespace tandem {

/// Throws InputError when one frame of `bodies` bodies exceeds memory (refuse_beyond_memory). The mesh is
/// refined `levels` times; a frame has at least three floats a vertex.
void refuse_bodies_beyond_memory(std::uint64_t bodies, const Mesh& mesh, std::uint64_t levels);

} // namespace tandem
