// SPDX-License-Identifier: MIT
// Settings and counters of walks over levels of tiles.
#pragma once

#include "algorithms/parameters/table.h"
#include "algorithms/traversal.h"

namespace tandem {

namespace tiled_parameters {
inline constexpr Setting<std::int64_t> tile_pair_capacity{"tile_pair_capacity", 262144,
                                                          ValueRange{1, parameters::word_limit}, "",
                                                          "initial capacity of a level in pairs of tiles"};
/// The value that 0 selects is measured: results/h200/README.md.
inline constexpr Setting<std::int64_t> most_seeds{"most_seeds", 0, ValueRange{0, std::int64_t{1} << 24}, "",
                                                  "maximum number of pairs of tiles with which bodies "
                                                  "start below their tops; 0: 16384 on GPUs, 256 elsewhere"};
} // namespace tiled_parameters

/// Counters in addition to those of every walk.
namespace tiled_counters {
inline constexpr Counter upper_tests{"upper_tests", "boxes", "tested node pairs above tetrahedra"};
inline constexpr Counter leaf_tile_pairs{"leaf_tile_pairs", "pairs of tiles",
                                         "pairs of tiles of tetrahedra that were tested, at least by their "
                                         "roots"};
} // namespace tiled_counters

} // namespace tandem
