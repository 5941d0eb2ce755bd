// SPDX-License-Identifier: MIT
// Settings of the chunked scheduler.
#pragma once

#include "algorithms/parameters/table.h"

namespace tandem::chunked_parameters {

/// Unit that walks seeds.
enum class Schedule {
    group, ///< a work-group walks the seeds of its batches that overlap
    item   ///< a work-item walks every seed a stride apart, as in the paper's code
};

/// Nodes that a step of a walk descends.
enum class Descent {
    both,   ///< both nodes at once, as in the paper's code
    larger, ///< the larger node only, which the paper calls biggest first, as gProximity does
    unlike  ///< the larger node if it is more than four times as wide as the other, else both
};

inline constexpr Setting<std::int64_t> chunk_bytes{"chunk_bytes", 8000, ValueRange{1, std::int64_t{1} << 30},
                                                   "", "memory of a pair of chunks in equation (1)"};
inline constexpr Setting<std::int64_t> leaves{"leaves", 0, ValueRange{0, 16384}, "",
                                              "tetrahedra per chunk, a power of two; 0: from chunk_bytes"};
inline constexpr Setting<std::int64_t> seed_threshold{
    "seed_threshold", 0, ValueRange{0, std::int64_t{1} << 31}, "SEED_THRESHOLD",
    "chunk pairs per body pair above which seeding climbs a level (the paper's: 1e7); 0: seed_target divided "
    "by the number of body pairs"};
inline constexpr Setting<std::int64_t> seed_target{
    "seed_target", 1048576, ValueRange{1, std::int64_t{1} << 31}, "SEED_TARGET",
    "maximum number of seeds in a frame, as far as levels allow, when seed_threshold is 0"};
inline constexpr Setting<Schedule> schedule{
    "schedule",
    Schedule::group,
    {{"group", Schedule::group}, {"item", Schedule::item}},
    "",
    "unit that walks seeds: a work-group those of its batches that overlap, or a work-item every seed a "
    "stride apart, as in the paper's code"};
inline constexpr Setting<Descent> descent{
    "descent",
    Descent::unlike,
    {{"both", Descent::both}, {"larger", Descent::larger}, {"unlike", Descent::unlike}},
    "DESCENT",
    "nodes that a step of a walk descends: both: both, as in the paper's code; larger: the larger one, which "
    "the paper calls biggest first; unlike: the larger one if it is more than four times as wide, else "
    "both"};
inline constexpr Setting<bool> root_test{
    "root_test",
    true,
    {{"yes", true}, {"no", false}},
    "ROOT_TEST",
    "resident: drop body pairs whose whole volumes do not overlap before seeding"};
inline constexpr Setting<std::int64_t> seed_capacity{"seed_capacity", 65536,
                                                     ValueRange{1, std::int64_t{1} << 31}, "",
                                                     "initial capacity for seeds handed down a level"};

} // namespace tandem::chunked_parameters
