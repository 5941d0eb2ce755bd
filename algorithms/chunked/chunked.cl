// SPDX-License-Identifier: MIT
// The chunked static scheduler (paper, sections 3.2 and 3.3). The seeds are pairs of chunks, and the
// assignment of walks to work-items is fixed before the launch. seeds.cl numbers the seeds.
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/broad_phase/body_pairs.clh"
#include "algorithms/chunked/walk.clh"

// Seeds of a launch: the level's own, `own` in number with a start for each of `pair_count` body pairs, then
// those handed down.
typedef struct {
    GLOBAL const ulong* starts;
    GLOBAL const uint* handed;
    ulong own;
    uint pair_count;
} SeedTables;

// Walk number `seed` of a launch. The level's own seeds from body pair `near` on include it.
DEVICE Walk walk_of_seed(const Job* job, const SeedTables* seeds, uint near, ulong seed) {
    if (seed >= seeds->own) {
        GLOBAL const uint* row = seeds->handed + (seed - seeds->own) * SEED_WORDS;
        const Seed given = {row[0], row[1], row[2]};
        return start_walk(job->trees, job->levels, job->pairs, job->level, given);
    }
    const uint pair = pair_from(seeds->starts, near, seeds->pair_count, seed);
    return walk_in_pair(job->trees, job->levels, job->pairs, job->level, pair, seed - seeds->starts[pair]);
}

// Number of seeds of a launch: the level's own and those handed down.
DEVICE ulong seed_total(ulong own, GLOBAL const uint* status, uint level, uint handed_capacity) {
    const uint above = status[STATUS_LEVELS + 2u * level];
    return own + (above < handed_capacity ? above : handed_capacity);
}

#define STACK_DEPTH MOST_WAITING(LEAF_BITS)

// Schedule `item`, the paper's: each work-item walks seeds a fixed stride apart, one after the other, with
// its own stack. One launch processes the seeds of one level. `seeds` has the starts of that level's own
// seeds.
KERNEL void traverse(GLOBAL const real* nodes, GLOBAL const uint* trees, GLOBAL const uint* levels,
                     GLOBAL const uint* bodies, GLOBAL const uint* ids, GLOBAL const uint* tetrahedra,
                     GLOBAL const uint* pairs, uint pair_capacity, uint level, GLOBAL const ulong* seeds,
                     GLOBAL const uint* handed, uint handed_capacity, GLOBAL uint* below, uint below_capacity,
                     GLOBAL uint* found, uint capacity, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, stacks, STACK_DEPTH * GROUP_SIZE);
    LOCAL uint* stack = stacks + LOCAL_ID;
    const Job job = {nodes, trees, levels,         pairs,
                     level, below, below_capacity, {bodies, ids, tetrahedra, found, capacity, status}};
    const uint pair_count = body_pair_count(pair_capacity, status);
    GLOBAL const ulong* starts = seeds + row_of_level(level, pair_count);
    const ulong own = starts[pair_count];
    const ulong total = seed_total(own, status, level, handed_capacity);
    ulong seed = GLOBAL_ID;
    uint top = 0;
    Walk walk = {{0u, 0u}, {0u, 0u}, 0u, 0u, 0u};
    Tally tally = empty_tally();
    while (top != 0u || seed < total) {
        Descent to = {1u, 1u, 0u, 0u};
        if (top == 0u) {
            const SeedTables tables = {starts, handed, own, pair_count};
            const uint near = seed < own ? pair_between(starts, 0u, pair_count, seed) : 0u;
            walk = walk_of_seed(&job, &tables, near, seed);
            seed += GLOBAL_COUNT;
            if (COUNT_WORK) tally.seeds += 1;
        } else {
            to = descent_of(&walk, stack[--top * GROUP_SIZE]);
        }
        for (uint a = to.first_a; a <= to.first_a + to.inner_a; ++a) {
            for (uint b = to.first_b; b <= to.first_b + to.inner_b; ++b) {
                if (is_behind(&job, &walk, a, b)) continue;
                if (COUNT_WORK) tally.tests += 1;
                if (!overlap(node_at(nodes, walk.a.base + a), node_at(nodes, walk.b.base + b))) continue;
                if (is_leaf(a, walk.a.items) && is_leaf(b, walk.b.items))
                    settle(&job, &walk, a, b, &tally);
                else
                    stack[top++ * GROUP_SIZE] = waiting(&job, &walk, a, b);
            }
        }
    }
    flush(&tally, status);
}

// A work-group's stack: rows of body pair, chunk of a, chunk of b, node pair. While there are fewer rows than
// work-items, the group tests the roots of at most BATCH seeds at a time. SHARED_RESERVE is the maximum
// number of rows that the walk of one row adds.
#define ROW_WORDS SHARED_ROW_WORDS
#define BATCH BATCH_SEEDS(GROUP_SIZE)
#define SHARED_RESERVE MOST_WAITING(LEAF_BITS)
#define SHARED_ROWS SHARED_ROW_COUNT(GROUP_SIZE, LEAF_BITS)

// Stored word by word, so that neighbouring work-items use different banks.
DEVICE void push_row(LOCAL uint* rows, uint count, LOCAL uint* pushed, Seed seed, uint nodes) {
    LOCAL uint* row = rows + count + LOCAL_ATOMIC_ADD(pushed, 1u);
    row[0] = seed.pair;
    row[SHARED_ROWS] = seed.chunk_a;
    row[2 * SHARED_ROWS] = seed.chunk_b;
    row[3 * SHARED_ROWS] = nodes;
}

// Number of rows that the group expands together. Each adds at most three. If they might exceed the capacity,
// the group expands one row, whose whole walk fits in the reserve.
DEVICE uint rows_to_take(uint count) {
    const uint capacity = ((uint)(SHARED_ROWS - SHARED_RESERVE) - count) / 3u;
    uint taken = count < (uint)GROUP_SIZE ? count : (uint)GROUP_SIZE;
    if (count >= (uint)(SHARED_ROWS - SHARED_RESERVE)) return 1u;
    taken = taken < capacity ? taken : capacity;
    return taken == 0u && count != 0u ? 1u : taken;
}

// Batches have equal sizes, in as few turns as BATCH allows. Few seeds are thus spread over all work-groups,
// and no group has more turns than needed.
DEVICE uint batch_size(ulong seeds) {
    const ulong most = (ulong)GROUP_COUNT * BATCH;
    const ulong batches = (seeds + most - 1u) / most * GROUP_COUNT;
    return batches == 0 ? 1u : (uint)((seeds + batches - 1u) / batches);
}

// Schedule `group`: batches of seeds are assigned to work-groups, a fixed stride apart. A group tests the
// roots of a batch, which few seeds pass. It expands the rest from a stack that its work-items share. All of
// them thus have work, however different the walks are.
KERNEL void traverse_in_groups(GLOBAL const real* nodes, GLOBAL const uint* trees, GLOBAL const uint* levels,
                               GLOBAL const uint* bodies, GLOBAL const uint* ids,
                               GLOBAL const uint* tetrahedra, GLOBAL const uint* pairs, uint pair_capacity,
                               uint level, GLOBAL const ulong* seeds, GLOBAL const uint* handed,
                               uint handed_capacity, GLOBAL uint* below, uint below_capacity,
                               GLOBAL uint* found, uint capacity, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, rows, SHARED_ROWS * ROW_WORDS);
    // Rows pushed in this turn, and in the one before, which slow work-items may still read. The third
    // counter is reset for the next turn.
    LOCAL_ARRAY(uint, pushed, 3);
    const Job job = {nodes, trees, levels,         pairs,
                     level, below, below_capacity, {bodies, ids, tetrahedra, found, capacity, status}};
    const uint all_pairs = body_pair_count(pair_capacity, status);
    GLOBAL const ulong* starts = seeds + row_of_level(level, all_pairs);
    const ulong own = starts[all_pairs];
    const ulong total = seed_total(own, status, level, handed_capacity);
    const uint batch = batch_size(total);
    ulong start = (ulong)GROUP_ID * batch;
    uint count = 0;
    uint turn = 0;
    Tally tally = empty_tally();
    if (LOCAL_ID == 0u) pushed[0] = 0u;
    BARRIER;
    do {
        const int collecting = count < (uint)GROUP_SIZE && start < total;
        const uint taken = collecting ? 0u : rows_to_take(count);
        uint row[ROW_WORDS];
        count -= taken;
        if (LOCAL_ID < taken)
            for (int i = 0; i < ROW_WORDS; ++i) row[i] = rows[i * SHARED_ROWS + count + LOCAL_ID];
        if (LOCAL_ID == 0u) pushed[(turn + 1u) % 3u] = 0u;
        BARRIER;
        if (collecting) {
            const uint pair_count = body_pair_count(pair_capacity, status); // read again to save registers
            const SeedTables tables = {starts, handed, own, pair_count};
            const uint near = start < own ? pair_between(starts, 0u, pair_count, start) : 0u;
            for (ulong seed = start + LOCAL_ID; seed < start + batch && seed < total; seed += GROUP_SIZE) {
                const Walk walk = walk_of_seed(&job, &tables, near, seed);
                if (COUNT_WORK) tally.seeds += 1;
                if (COUNT_WORK) tally.tests += 1;
                if (!roots_overlap(&job, &walk)) continue;
                const Seed chunks = {walk.pair, walk.first_a / CHUNK_ITEMS, walk.first_b / CHUNK_ITEMS};
                push_row(rows, count, pushed + turn, chunks, waiting(&job, &walk, 1u, 1u));
            }
            start += (ulong)GROUP_COUNT * batch;
        } else if (LOCAL_ID < taken) {
            const Seed chunks = {row[0], row[1], row[2]};
            const Walk walk = start_walk(trees, levels, pairs, level, chunks);
            const Children children = expand(&job, &walk, row[3], &tally);
            for (uint i = 0; i < 4u; ++i)
                if (((children.left >> i) & 1u) != 0u)
                    push_row(rows, count, pushed + turn, chunks, child_pair(&children, i));
        }
        BARRIER;
        count += pushed[turn];
        turn = (turn + 1u) % 3u;
    } while (count != 0u || start < total);
    flush(&tally, status);
}
