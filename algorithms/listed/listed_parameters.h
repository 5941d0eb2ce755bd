// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/table.h"
#include "algorithms/traversal.h"

namespace tandem {

namespace listed_parameters {
inline constexpr Setting<std::int64_t> pad{"pad", 60, ValueRange{1, 1000000}, "",
                                           "largest pad of a list, in thousandths of the mean length of a "
                                           "tetrahedron's bounding box; a list has the "
                                           "least pad with which it is expected to last twelve frames"};
inline constexpr Setting<std::int64_t> list_capacity{
    "list_capacity", 1048576, ValueRange{1, parameters::word_limit}, "",
    "initial capacity for the certain pairs of a list, and for its open pairs"};
} // namespace listed_parameters

/// Counters in addition to those of tiled.
namespace listed_counters {
inline constexpr Counter certain_pairs{"certain_pairs", "pairs",
                                       "pairs of lists that frames took without a test"};
inline constexpr Counter open_pairs{"open_pairs", "pairs", "pairs of lists that frames tested"};
inline constexpr Counter lists{"lists", "frames", "frames that made a list"};
inline constexpr Counter direct_walks{"direct_walks", "frames", "frames walked without a list"};
} // namespace listed_counters

} // namespace tandem
