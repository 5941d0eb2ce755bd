// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"

#include <cstdint>

namespace tandem {

/// Depths of a strip of refit.cl below its root, at most.
inline constexpr std::uint32_t strip_height = 5;

/// How refit_strips is compiled.
struct RefitShape {
    std::uint32_t group_size; ///< a power of two
    std::uint32_t tile_nodes; ///< TILE_NODES: a power of two; every team has room for a strip of strip_height
};

/// Of groups of `group_size` work-items or fewer: small enough that several share a compute unit and that
/// the tile takes no more local memory than every device has (32 KiB, OpenCL 1.2, 4.2).
RefitShape refit_shape(const Geometry& geometry, std::uint32_t group_size);

/// Strips of `height` <= strip_height that a work-group takes, all its teams together.
std::uint32_t strips_of_group(const RefitShape& shape, std::uint32_t height);

} // namespace tandem
