// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/export/glb_file.h"
#include "scenes/export/surfaces.h"

#include <optional>

namespace tandem::exporting {

/// Adds the contact surfaces of each frame as a node, with triangles that have the pressure of each corner as
/// attribute _PRESSURE, and its colour as a part of the largest pressure of all frames. Returns the nodes; a
/// frame without polygons has none. All but the first are hidden, by a scale of 0.
std::vector<std::optional<std::size_t>> add_surfaces(GlbFile& file, std::span<const SurfaceFrames> frames);

} // namespace tandem::exporting
