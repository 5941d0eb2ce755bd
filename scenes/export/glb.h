// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

namespace tandem {

/// Writes frames first..last of a scene as a binary glTF file: boundary surfaces, one for all bodies with the
/// same mesh; rigid bodies move by an animation with one key a frame, in the scene's times or at 25 frames a
/// second. Deformable bodies stand as in frame `first`. Throws InputError, also when the file would pass
/// glTF's 4 GiB.
void write_glb(const std::string& path, const Scene& scene, std::size_t first, std::size_t last);

} // namespace tandem
