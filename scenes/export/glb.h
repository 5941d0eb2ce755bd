// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/export/surfaces.h"

namespace tandem {

/// Writes frames of a scene as a binary glTF file. It has boundary surfaces, one for all rigid bodies of a
/// mesh, and an animation with a key for each frame, at the scene's times or 25 a second. Rigid bodies move
/// as nodes, deformable bodies by a morph target a frame. With `surfaces` it also has the contact surfaces of
/// each frame, coloured by pressure, and bodies are translucent; their number of polygons is returned.
/// `frames` has at least one frame, in ascending order. Throws InputError, also when the file would exceed
/// glTF's 4 GiB.
std::size_t write_glb(const std::string& path, const Scene& scene, std::span<const std::size_t> frames,
                      const FindSurfaces& surfaces = {});

} // namespace tandem
