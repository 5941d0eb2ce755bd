// SPDX-License-Identifier: MIT
#pragma once

#include "harness/report/scene_cut.h"

#include <span>
#include <string>

namespace tandem {
struct Scene;
class FrameContacts;
} // namespace tandem

namespace tandem::report {

/// Frames of a scene for the page to draw, as JSON text: surfaces with the chunk of each triangle, poses,
/// vertices of deformable bodies, contacts where there is a finder. What does not fit the budget is left out,
/// and its notes say so.
std::string scene_data(const Scene& scene, std::span<const std::size_t> frames, FrameContacts* finder,
                       const SceneBudget& budget);

} // namespace tandem::report
