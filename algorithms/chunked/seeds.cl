// SPDX-License-Identifier: MIT
// Numbers the seeds of a frame before the walks. A file of its own, because the walks depend on more
// settings.
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/chunked/seeds.clh"

#ifndef ROOT_TEST
#define ROOT_TEST 1
#endif

// seeds[row_of_level(level) + pair] = number of chunk pairs that a body pair starts with at that level.
KERNEL void count_seeds(GLOBAL const real* volumes, GLOBAL const uint* trees, GLOBAL const uint* levels,
                        GLOBAL const uint* pairs, uint pair_capacity, uint level_count, GLOBAL ulong* seeds,
                        GLOBAL const uint* status) {
    const uint pair_count = body_pair_count(pair_capacity, status);
    const ulong threshold = seed_threshold(pair_count);
    for (ulong pair = GLOBAL_ID; pair < pair_count; pair += GLOBAL_COUNT) { // 32 bits might wrap around
        const uint body_a = body_a_of(pairs, (uint)pair);
        const uint body_b = body_b_of(pairs, (uint)pair);
        GLOBAL const uint* a = tree_of(trees, body_a);
        GLOBAL const uint* b = tree_of(trees, body_b);
        const uint own = seed_level(a, b, levels, threshold, level_count);
        const ulong chunks_a = level_of(levels, a, own)[LEVEL_CHUNKS];
        const ulong chunks_b = level_of(levels, b, own)[LEVEL_CHUNKS];
        const int apart = ROOT_TEST ? !overlap(volume_of(volumes, body_a), volume_of(volumes, body_b)) : 0;
        const ulong walks = apart ? 0 : chunks_a * chunks_b;
        for (uint level = 0; level < level_count; ++level)
            seeds[row_of_level(level, pair_count) + pair] = level == own ? walks : 0;
    }
}

// Turns each level's counts into starts, with the total at the end. One work-group per level: each work-item
// sums a contiguous part, work-item 0 scans the parts.
KERNEL void scan_seeds(GLOBAL ulong* seeds, uint pair_capacity, GLOBAL const uint* status) {
    LOCAL_ARRAY(ulong, parts, GROUP_SIZE);
    const uint pair_count = body_pair_count(pair_capacity, status);
    GLOBAL ulong* row = seeds + row_of_level(GROUP_ID, pair_count);
    const ulong part = ((ulong)pair_count + GROUP_SIZE - 1) / GROUP_SIZE;
    const ulong first = LOCAL_ID * part < pair_count ? LOCAL_ID * part : pair_count;
    const ulong last = first + part < pair_count ? first + part : pair_count;
    ulong sum = 0;
    for (ulong i = first; i < last; ++i) sum += row[i];
    parts[LOCAL_ID] = sum;
    BARRIER;
    if (LOCAL_ID == 0u) {
        ulong start = 0;
        for (uint i = 0; i < (uint)GROUP_SIZE; ++i) {
            const ulong own = parts[i];
            parts[i] = start;
            start += own;
        }
        row[pair_count] = start;
    }
    BARRIER;
    ulong start = parts[LOCAL_ID];
    for (ulong i = first; i < last; ++i) {
        const ulong own = row[i];
        row[i] = start;
        start += own;
    }
}
