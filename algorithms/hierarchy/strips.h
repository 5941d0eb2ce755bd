// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"

#include <cstdint>

namespace tandem {

/// Maximum number of depths of a strip of refit.cl below its root.
inline constexpr std::uint32_t strip_height = 5;

/// Whether refit_strips makes the nodes of the lowest depth together with their parents (IN_PAIRS of
/// refit.cl).
inline bool in_pairs(const Geometry& geometry) { return ends_of_node(geometry) <= 8; }

/// Compile-time parameters of refit_strips.
struct RefitShape {
    std::uint32_t group_size; ///< a power of two
    std::uint32_t
        tile_nodes; ///< TILE_NODES: a power of two; each team has capacity for one strip of strip_height
};

/// Shape for groups of at most `group_size` work-items. Several groups fit on a compute unit, and the tile
/// needs no more local memory than every device has (32 KiB, OpenCL 1.2, 4.2).
RefitShape refit_shape(const Geometry& geometry, std::uint32_t group_size);

/// Strips of `height` <= strip_height per work-group, all its teams together.
std::uint32_t strips_of_group(const RefitShape& shape, std::uint32_t height);

} // namespace tandem
