// SPDX-License-Identifier: MIT
// The chunked static scheduler (paper, sections 3.2 and 3.3): pairs of chunks are the seeds; every work-item
// walks seed after seed, a fixed stride apart, with a stack of its own in local memory and simultaneous
// descent.
#include "backends/portable.h"
#include "algorithms/pairs.clh"

#ifndef SEED_THRESHOLD
#define SEED_THRESHOLD 10000000
#endif
#ifndef ROOT_TEST
#define ROOT_TEST 1
#endif

// Every expansion pops one node pair and pushes at most four, and a walk expands at most LEAF_BITS deep.
#define STACK_DEPTH (3 * LEAF_BITS + 1)
#define SEED_WORDS                                                                                           \
    3 // body pair, chunk of a, chunk of b: seeds handed down from super chunks, or made by the host

// The level a pair of bodies is seeded at: climb from level 0 while both have a higher one and the count of
// chunk pairs is above the threshold (section 3.2; Algorithm 4 as printed runs the other way).
DEVICE uint seed_level(GLOBAL const uint* a, GLOBAL const uint* b, GLOBAL const uint* levels) {
    uint level = 0;
    while (level + 1u < a[BODY_LEVEL_COUNT] && level + 1u < b[BODY_LEVEL_COUNT]) {
        const ulong chunks_a = levels[(ulong)(a[BODY_LEVELS] + level) * LEVEL_WORDS + LEVEL_CHUNKS];
        const ulong chunks_b = levels[(ulong)(b[BODY_LEVELS] + level) * LEVEL_WORDS + LEVEL_CHUNKS];
        if (chunks_a * chunks_b <= (ulong)SEED_THRESHOLD) break;
        ++level;
    }
    return level;
}

// seeds[level * (pair_count + 1) + pair] = number of chunk pairs that body pair starts with at that level.
KERNEL void count_seeds(GLOBAL const real* nodes, GLOBAL const uint* bodies, GLOBAL const uint* levels,
                        GLOBAL const uint* pairs, uint pair_count, uint level_count, GLOBAL ulong* seeds) {
    for (uint pair = GLOBAL_ID; pair < pair_count; pair += GLOBAL_COUNT) {
        GLOBAL const uint* a = bodies + (ulong)pairs[2u * pair] * BODY_WORDS;
        GLOBAL const uint* b = bodies + (ulong)pairs[2u * pair + 1u] * BODY_WORDS;
        const uint own = seed_level(a, b, levels);
        const ulong chunks_a = levels[(ulong)(a[BODY_LEVELS] + own) * LEVEL_WORDS + LEVEL_CHUNKS];
        const ulong chunks_b = levels[(ulong)(b[BODY_LEVELS] + own) * LEVEL_WORDS + LEVEL_CHUNKS];
        const int apart = ROOT_TEST && !overlap(node_at(nodes, a[BODY_NODES]), node_at(nodes, b[BODY_NODES]));
        for (uint level = 0; level < level_count; ++level)
            seeds[(ulong)level * (pair_count + 1u) + pair] = level == own && !apart ? chunks_a * chunks_b : 0;
    }
}

// Turns each level's counts into starts, with the total at the end: one work-group a level; each work-item
// sums a contiguous part, work-item 0 scans the parts.
KERNEL void scan_seeds(GLOBAL ulong* seeds, uint pair_count) {
    LOCAL_ARRAY(ulong, parts, GROUP_SIZE);
    GLOBAL ulong* row = seeds + (ulong)GROUP_ID * (pair_count + 1u);
    const uint part = (pair_count + (uint)GROUP_SIZE - 1u) / (uint)GROUP_SIZE;
    const uint first = LOCAL_ID * part < pair_count ? LOCAL_ID * part : pair_count;
    const uint last = first + part < pair_count ? first + part : pair_count;
    ulong sum = 0;
    for (uint i = first; i < last; ++i) sum += row[i];
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
    for (uint i = first; i < last; ++i) {
        const ulong own = row[i];
        row[i] = start;
        start += own;
    }
}

// The pair whose seeds include number `seed`: the last one that starts at or before it.
DEVICE uint pair_of_seed(GLOBAL const ulong* starts, uint pair_count, ulong seed) {
    uint low = 0;
    uint high = pair_count;
    while (low + 1u < high) {
        const uint middle = low + (high - low) / 2u;
        if (starts[middle] <= seed)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// A walk in progress: two chunks, and where their items lead.
typedef struct {
    Chunk a, b;
    uint pair, first_a, first_b; // first item of each chunk
} Walk;

DEVICE Walk start_walk(GLOBAL const uint* bodies, GLOBAL const uint* levels, GLOBAL const uint* pairs,
                       uint level, uint pair, uint chunk_a, uint chunk_b) {
    GLOBAL const uint* a = bodies + (ulong)pairs[2u * pair] * BODY_WORDS;
    GLOBAL const uint* b = bodies + (ulong)pairs[2u * pair + 1u] * BODY_WORDS;
    Walk walk;
    walk.pair = pair;
    walk.first_a = chunk_a * CHUNK_ITEMS;
    walk.first_b = chunk_b * CHUNK_ITEMS;
    walk.a = chunk_at(a[BODY_NODES], levels + (ulong)(a[BODY_LEVELS] + level) * LEVEL_WORDS, chunk_a);
    walk.b = chunk_at(b[BODY_NODES], levels + (ulong)(b[BODY_LEVELS] + level) * LEVEL_WORDS, chunk_b);
    return walk;
}

// Walk number `seed` of this launch: those of the level's own table first, then those handed down from above.
DEVICE Walk walk_of_seed(GLOBAL const uint* bodies, GLOBAL const uint* levels, GLOBAL const uint* pairs,
                         uint pair_count, GLOBAL const ulong* starts, ulong own, GLOBAL const uint* handed,
                         uint level, ulong seed) {
    if (seed >= own) {
        GLOBAL const uint* row = handed + (seed - own) * SEED_WORDS;
        return start_walk(bodies, levels, pairs, level, row[0], row[1], row[2]);
    }
    const uint pair = pair_of_seed(starts, pair_count, seed);
    GLOBAL const uint* b = bodies + (ulong)pairs[2u * pair + 1u] * BODY_WORDS;
    const ulong chunks_b = levels[(ulong)(b[BODY_LEVELS] + level) * LEVEL_WORDS + LEVEL_CHUNKS];
    const ulong rest = seed - starts[pair];
    return start_walk(bodies, levels, pairs, level, pair, (uint)(rest / chunks_b), (uint)(rest % chunks_b));
}

// Hands a pair of chunks down to the level below.
DEVICE void hand_down(GLOBAL uint* status, uint level, GLOBAL uint* below, uint capacity, uint pair, uint a,
                      uint b) {
    const uint index = counter_add(status + STATUS_LEVELS + 2u * (level - 1u), 1u);
    if (index < capacity) {
        GLOBAL uint* row = below + (ulong)index * SEED_WORDS;
        row[0] = pair;
        row[1] = a;
        row[2] = b;
    }
}

// One launch walks the seeds of one level. `seeds` holds the starts of that level's own seeds; `handed` the
// seeds from the level above (or the host's), `below` takes those for the level below. Node pairs on the
// stack overlap.
KERNEL void traverse(GLOBAL const real* nodes, GLOBAL const uint* bodies, GLOBAL const uint* levels,
                     GLOBAL const uint* ids, GLOBAL const uint* pairs, uint pair_count, uint level,
                     GLOBAL const ulong* seeds, GLOBAL const uint* handed, uint handed_capacity,
                     GLOBAL uint* below, uint below_capacity, GLOBAL uint* found, uint capacity,
                     GLOBAL uint* status) {
    LOCAL_ARRAY(uint, stacks, STACK_DEPTH * GROUP_SIZE);
    GLOBAL const ulong* starts = seeds + (ulong)level * (pair_count + 1u);
    const ulong own = starts[pair_count];
    const uint above = status[STATUS_LEVELS + 2u * level];
    const ulong total = own + (above < handed_capacity ? above : handed_capacity);
    ulong seed = GLOBAL_ID;
    uint top = 0;
    Walk walk = {{0u, 0u}, {0u, 0u}, 0u, 0u, 0u};
    Tally tally = empty_tally();
    while (top != 0u || seed < total) {
        uint first_a = 1u;
        uint first_b = 1u;
        uint last_a = 1u;
        uint last_b = 1u;
        if (top == 0u) {
            walk = walk_of_seed(bodies, levels, pairs, pair_count, starts, own, handed, level, seed);
            seed += GLOBAL_COUNT;
            if (COUNT_WORK) tally.seeds += 1;
        } else {
            --top;
            const uint node_a = stacks[top * GROUP_SIZE + LOCAL_ID] >> 16;
            const uint node_b = stacks[top * GROUP_SIZE + LOCAL_ID] & 0xffffu;
            const uint leaf_a = is_leaf(node_a, walk.a.items) ? 0u : 1u;
            const uint leaf_b = is_leaf(node_b, walk.b.items) ? 0u : 1u;
            first_a = node_a << leaf_a;
            last_a = first_a + leaf_a;
            first_b = node_b << leaf_b;
            last_b = first_b + leaf_b;
        }
        for (uint a = first_a; a <= last_a; ++a) {
            for (uint b = first_b; b <= last_b; ++b) {
                if (COUNT_WORK) tally.tests += 1;
                if (!overlap(node_at(nodes, walk.a.base + a), node_at(nodes, walk.b.base + b))) continue;
                if (!is_leaf(a, walk.a.items) || !is_leaf(b, walk.b.items)) {
                    stacks[top * GROUP_SIZE + LOCAL_ID] = a << 16 | b;
                    ++top;
                    continue;
                }
                const uint item_a = walk.first_a + leaf_item(a, walk.a.items);
                const uint item_b = walk.first_b + leaf_item(b, walk.b.items);
                if (level == 0u)
                    emit(&tally, status, found, capacity, bodies, ids, pairs[2u * walk.pair],
                         pairs[2u * walk.pair + 1u], item_a, item_b);
                else
                    hand_down(status, level, below, below_capacity, walk.pair, item_a, item_b);
            }
        }
    }
    flush(&tally, status);
}
