// SPDX-License-Identifier: MIT
#pragma once

#include "base/memory.h"
#include "scenes/mesh.h"

namespace tandem {

/// refuse_beyond_memory() for bodies of one mesh after `levels` refinements, by what a frame of them has at
/// least: three floats a vertex.
void refuse_bodies_beyond_memory(std::uint64_t bodies, const Mesh& mesh, std::uint64_t levels);

} // namespace tandem
