// SPDX-License-Identifier: MIT
#pragma once

#include "harness/flaws.h"
#include "scenes/scene.h"

#include <vector>

namespace tandem {

/// Frames FIRST..LAST of a scene, made before anything is measured.
struct FrameRange {
    std::size_t first = 0;
    std::size_t last = 0;
    std::vector<Frame> frames;
    Flaws flaws{}; ///< of these frames, and how they were handled
};

/// Throws InputError when the scene has no such frames, which says why.
void check_frames(const Scene& scene, std::size_t first, std::size_t last);

/// The frames, once checked.
FrameRange make_frames(const Scene& scene, std::size_t first, std::size_t last);

} // namespace tandem
