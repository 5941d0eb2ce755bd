// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/export/glb_file.h"
#include "scenes/scene.h"

#include <optional>

namespace tandem::exporting {

/// Adds the animation of a scene through `frames`. Node i of the file must be body i. A deformable body must
/// have its own mesh with the vertices of the first frame. `shown[i]`, if any, is a node that is shown in
/// frame i only.
void add_animation(GlbFile& file, const Scene& scene, std::span<const std::size_t> frames,
                   std::span<const std::optional<std::size_t>> shown = {});

/// A lower bound of the bytes of numbers in the animation.
std::uint64_t animation_bytes(const Scene& scene, std::size_t frames);

} // namespace tandem::exporting
