// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

namespace tandem {

/// Writes frames of a scene as a binary glTF file: boundary surfaces, one for all rigid bodies with the same
/// mesh, and an animation with a key for each of `frames` (ascending, one at least), at the scene's times or
/// 25 a second. Rigid bodies move as nodes, deformable ones by a morph target a frame. Throws InputError,
/// also when the file would pass glTF's 4 GiB.
void write_glb(const std::string& path, const Scene& scene, std::span<const std::size_t> frames);

} // namespace tandem
