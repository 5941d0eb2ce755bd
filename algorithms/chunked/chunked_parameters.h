// SPDX-License-Identifier: MIT
// The chunked scheduler's own settings.
#pragma once

#include "algorithms/parameters/table.h"

namespace tandem::chunked_parameters {

/// Who walks.
enum class Schedule {
    group, ///< a work-group, those seeds of its batches that overlap
    item   ///< a work-item, every seed a stride apart, as the paper's code
};

/// What a step of a walk descends.
enum class Descent {
    both,  ///< both nodes at once, as the paper's code
    larger ///< of two nodes of unlike size the larger alone
};

inline constexpr Setting<std::int64_t> chunk_bytes{"chunk_bytes", 8000, ValueRange{1, std::int64_t{1} << 30},
                                                   "", "memory of a pair of chunks in equation (1)"};
inline constexpr auto leaves =
    Setting<std::int64_t>{"leaves", 0, ValueRange{0, 16384}, "",
                          "tetrahedra per chunk, a power of two; 0: from chunk_bytes"}
        .with_alternatives({8, 64, 512}, "chunk_bytes");
inline constexpr Setting<std::int64_t> seed_threshold{
    "seed_threshold", 0, ValueRange{0, std::int64_t{1} << 31}, "SEED_THRESHOLD",
    "chunk pairs per body pair above which seeding climbs a level (the paper's: 1e7); 0: seed_target shared "
    "by the frame's body pairs"};
inline constexpr Setting<std::int64_t> seed_target{
    "seed_target", 1048576, ValueRange{1, std::int64_t{1} << 31}, "SEED_TARGET",
    "seeds a frame is to have at most, as far as levels allow, when seed_threshold is 0"};
inline constexpr Setting<Schedule> schedule{
    "schedule",
    Schedule::group,
    {{"group", Schedule::group}, {"item", Schedule::item}},
    "",
    "who walks: a work-group the seeds of its batches that overlap, or, as the paper's code, a work-item "
    "every seed a stride apart"};
inline constexpr Setting<Descent> descent{
    "descent",
    Descent::larger,
    {{"larger", Descent::larger}, {"both", Descent::both}},
    "DESCEND_LARGER",
    "what a step of a walk descends: of two nodes of unlike size the larger alone, or always both at once, "
    "as the paper's code"};
inline constexpr Setting<bool> root_test{
    "root_test",
    true,
    {{"yes", true}, {"no", false}},
    "ROOT_TEST",
    "resident: drop body pairs whose whole volumes are apart before seeding"};
inline constexpr Setting<std::int64_t> seed_capacity{"seed_capacity", 65536,
                                                     ValueRange{1, std::int64_t{1} << 31}, "",
                                                     "seeds handed down a level there is room for at first"};

} // namespace tandem::chunked_parameters
