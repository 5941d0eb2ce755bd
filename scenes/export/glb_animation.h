// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/export/glb_file.h"
#include "scenes/scene.h"

namespace tandem::exporting {

/// The animation of a scene through `frames`. Node i of the file is body i, and the mesh of a deformable body
/// is its own and stands as in the first frame.
void add_animation(GlbFile& file, const Scene& scene, std::span<const std::size_t> frames);

/// About how many bytes of numbers it takes, from below.
std::uint64_t animation_bytes(const Scene& scene, std::size_t frames);

} // namespace tandem::exporting
