// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/kernels/launch_shape.h"
#include "algorithms/bodies/cost.h"
#include "algorithms/parameters/table.h"
#include "algorithms/traversal.h"

namespace tandem {

/// Ends of slabs in the bounds of a tetrahedron.
double leaf_words_of(const Settings& settings, Slabs slabs);

/// Groups of the tile kernels: as large as the setting and local memory allow. Doubles with many directions
/// need more than 48 KiB in groups of 128.
LaunchShape fitting_shape(const Settings& settings, Slabs slabs, const DeviceInfo& info, LaunchShape shape);

/// Resolves most_seeds and group_size where they are 0 and their values depend on the device.
void fit_tiles(Settings& settings, const DeviceInfo& info);

/// Throws InputError if the smallest groups need more local memory than the device has.
void check_tile_memory(const Settings& settings, Slabs slabs, const DeviceInfo& info);

/// The cost of walk_upper_tiles.
KernelCost upper_tiles_cost(double k);

/// Bytes of the pairs of tiles of tetrahedra in a frame.
double leaf_tile_pair_bytes(const FrameFacts& facts);

} // namespace tandem
