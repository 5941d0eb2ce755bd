// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

namespace tandem {

/// 64-bit digest of a frame: poses, vertices of deformable bodies, and skipped tetrahedra.
std::uint64_t digest_of(const Frame& frame);

/// 64-bit digest of a scene: key, meshes, bodies, and the states of the first and the last frame. The key
/// has every parameter of the motion, so that the frames between need not be read.
std::uint64_t digest_of(const Scene& scene);

} // namespace tandem
