// SPDX-License-Identifier: MIT
// Canonical order of an answer: pairs by the numbers of their bodies and tetrahedra, contacts by pair and
// feature. Pairs are counted by a first key, whose sums give each key its run of places. They go to places of
// their run in any order. The rank of a pair's second key in its run is then its place. Runs are short: most
// have fewer than 32 pairs. Second keys of a run differ. Of contacts, each pair gets a mask of its features;
// a contact's place in the run of its pair is then the number of lower features.
// Host variants: PRECISION
#include "backends/portable.h"
#include "algorithms/answer/pairs.clh"
#include "algorithms/kernels/parts.clh"

// Places in the order of the scene of a pair's tetrahedra. `places`: that of each slot, or of each item, the
// first of a body at `firsts`.
DEVICE WordPair places_of(GLOBAL const uint* found, ulong index, GLOBAL const uint* firsts,
                          GLOBAL const uint* places) {
    WordPair pair;
    if (PAIR_LAYOUT == PAIR_SLOTS) {
        const WordPair slots = ((GLOBAL const WordPair*)found)[index];
        pair.x = places[slots.x];
        pair.y = places[slots.y];
    } else {
        const WordRow items = ((GLOBAL const WordRow*)found)[index];
        pair.x = places[firsts[items.x] + items.z];
        pair.y = places[firsts[items.y] + items.w];
    }
    return pair;
}

// counts[place of a] += 1 for each pair. Stores the count before, which is the pair's place in its run.
KERNEL void count_pairs(GLOBAL const uint* found, uint capacity, GLOBAL const uint* firsts,
                        GLOBAL const uint* places, GLOBAL uint* counts, GLOBAL uint* before,
                        GLOBAL const uint* status) {
    const uint rows = rows_in(status + STATUS_PAIRS, capacity);
    for (ulong i = GLOBAL_ID; i < rows; i += GLOBAL_COUNT) // 32 bits might wrap around
        before[i] = ATOMIC_ADD(counts + places_of(found, i, firsts, places).x, 1u);
}

// Rows of contacts that were written. If not all fit, a stage that reduces them (`reduced`) has written none.
DEVICE uint contacts_in(GLOBAL const uint* status, uint capacity, uint reduced) {
    const uint rows = rows_in(status + STATUS_CONTACTS, capacity);
    const int fit = status[STATUS_CONTACTS + 1] == 0u && status[STATUS_CONTACTS] == rows;
    return reduced != 0u && !fit ? 0u : rows;
}

// Two words for each pair: bits of the features of its contacts, which differ modulo 64. Each sets one bit.
KERNEL void mark_contacts(GLOBAL const uint* contact_ids, uint capacity, uint reduced, GLOBAL uint* masks,
                          GLOBAL const uint* status) {
    const uint rows = contacts_in(status, capacity, reduced);
    for (ulong i = GLOBAL_ID; i < rows; i += GLOBAL_COUNT) {
        const WordPair contact = ((GLOBAL const WordPair*)contact_ids)[i];
        ATOMIC_ADD(masks + 2 * (ulong)contact.x + contact.y / 32u % 2u, 1u << contact.y % 32u);
    }
}

// What key i counts: of tetrahedra `counts`, of pairs (`by_pair`) the bits of their masks.
DEVICE uint count_at(GLOBAL const uint* counts, uint i, uint by_pair) {
    if (by_pair == 0u) return counts[i];
    const WordPair mask = ((GLOBAL const WordPair*)counts)[i];
    return COUNT_ONES(mask.x) + COUNT_ONES(mask.y);
}

// A work-item's share of the sum of values first..end - 1: those a fixed stride apart.
DEVICE uint strided_sum(GLOBAL const uint* counts, uint first, uint end, uint by_pair) {
    uint sum = 0;
    for (uint i = first + LOCAL_ID; i < end; i += (uint)GROUP_SIZE) sum += count_at(counts, i, by_pair);
    return sum;
}

// Number of keys: `count`, or if keys are pairs (`by_pair`) that of the pairs found, at most `count`.
DEVICE uint keys_in(GLOBAL const uint* status, uint count, uint by_pair) {
    return by_pair != 0u ? rows_in(status + STATUS_PAIRS, count) : count;
}

// sums[group] = sum of the group's part.
KERNEL void sum_parts(GLOBAL const uint* counts, uint most, uint by_pair, GLOBAL uint* sums,
                      GLOBAL const uint* status) {
    LOCAL_ARRAY(uint, own_sums, GROUP_SIZE);
    const uint count = keys_in(status, most, by_pair);
    own_sums[LOCAL_ID] =
        strided_sum(counts, group_first(GROUP_ID, count), group_first(GROUP_ID + 1u, count), by_pair);
    BARRIER;
    if (LOCAL_ID != 0u) return;
    uint all = 0;
    for (uint i = 0; i < (uint)GROUP_SIZE; ++i) all += own_sums[i];
    sums[GROUP_ID] = all;
}

// Adjacent counts that a work-item sums in a turn. Neighbouring work-items load and store neighbouring
// counts, and exchange them in local memory, where the counts of two work-items lie one word apart.
#define COUNTS_EACH 16u
#define EACH_STRIDE (COUNTS_EACH + 1u)

// Replaces the values of a work-group by the sums up to and including each.
DEVICE void scan(LOCAL uint* values) {
    for (uint distance = 1u; distance < (uint)GROUP_SIZE; distance *= 2u) {
        const uint before = LOCAL_ID >= distance ? values[LOCAL_ID - distance] : 0u;
        BARRIER;
        values[LOCAL_ID] += before;
        BARRIER;
    }
}

// The first place of each key. `starts`: may be `counts`.
KERNEL void start_runs(GLOBAL const uint* counts, uint most, uint by_pair, GLOBAL const uint* sums,
                       GLOBAL uint* starts, GLOBAL const uint* status) {
    LOCAL_ARRAY(uint, staged, GROUP_SIZE * EACH_STRIDE);
    LOCAL_ARRAY(uint, ends, GROUP_SIZE);
    const uint count = keys_in(status, most, by_pair);
    const uint end = group_first(GROUP_ID + 1u, count);
    uint first = group_first(GROUP_ID, count);
    ends[LOCAL_ID] = strided_sum(sums, 0u, GROUP_ID, 0u);
    BARRIER;
    scan(ends);
    uint start = ends[GROUP_SIZE - 1]; // the sum of the parts before this one
    LOCAL uint* own = staged + LOCAL_ID * EACH_STRIDE;
    do { // runs at least once, as loops with barriers must
        const uint left = end - first;
        for (uint i = LOCAL_ID; i < COUNTS_EACH * (uint)GROUP_SIZE; i += (uint)GROUP_SIZE)
            staged[i / COUNTS_EACH * EACH_STRIDE + i % COUNTS_EACH] =
                i < left ? count_at(counts, first + i, by_pair) : 0u;
        BARRIER;
        uint sum = 0;
        for (uint i = 0; i < COUNTS_EACH; ++i) sum += own[i];
        ends[LOCAL_ID] = sum;
        BARRIER;
        scan(ends);
        uint next = start + ends[LOCAL_ID] - sum;
        start += ends[GROUP_SIZE - 1];
        for (uint i = 0; i < COUNTS_EACH; ++i) {
            const uint value = own[i];
            own[i] = next;
            next += value;
        }
        BARRIER;
        for (uint i = LOCAL_ID; i < COUNTS_EACH * (uint)GROUP_SIZE && i < left; i += (uint)GROUP_SIZE)
            starts[first + i] = staged[i / COUNTS_EACH * EACH_STRIDE + i % COUNTS_EACH];
        BARRIER;
        first = left > COUNTS_EACH * (uint)GROUP_SIZE ? first + COUNTS_EACH * (uint)GROUP_SIZE : end;
    } while (first < end);
}

// Puts the place of b of each pair at its place in the run of a.
KERNEL void scatter_pairs(GLOBAL const uint* found, uint capacity, GLOBAL const uint* firsts,
                          GLOBAL const uint* places, GLOBAL const uint* starts, GLOBAL const uint* before,
                          GLOBAL uint* keys, GLOBAL const uint* status) {
    const uint count = rows_in(status + STATUS_PAIRS, capacity);
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        const WordPair pair = places_of(found, i, firsts, places);
        keys[starts[pair.x] + before[i]] = pair.y;
    }
}

DEVICE void swap_keys(GLOBAL uint* keys, uint i, uint j) {
    const uint key = keys[i];
    keys[i] = keys[j];
    keys[j] = key;
}

// Restores the heap of the keys of rows first..first + count - 1 below `node`.
DEVICE void sift(GLOBAL uint* keys, uint first, uint count, uint node) {
    while (2u * node + 1u < count) {
        uint child = 2u * node + 1u;
        if (child + 1u < count && keys[first + child + 1u] > keys[first + child]) ++child;
        if (keys[first + node] >= keys[first + child]) return;
        swap_keys(keys, first + node, first + child);
        node = child;
    }
}

// Longer runs are sorted as a heap by one work-item: ranks take time with the square of a run's length.
#define MOST_RANKED 512u

// Sorts the keys of rows first..end - 1.
DEVICE void sort_run(GLOBAL uint* keys, uint first, uint end) {
    const uint count = end - first;
    for (uint node = count / 2u; node > 0u; --node) sift(keys, first, count, node - 1u);
    for (uint last = count - 1u; last > 0u; --last) {
        swap_keys(keys, first, first + last);
        sift(keys, first, last, 0u);
    }
}

// The runs of TEAM_SIZE adjacent keys, whose rows are adjacent too: run i has rows starts[i]..starts[i + 1] -
// 1.
#define STARTS (TEAM_SIZE + 1)

// Loads the runs of a team from key `key` - TEAM_LANE on. Keys from `count` on have no rows. `end`: the
// number of all rows.
DEVICE void load_starts(GLOBAL const uint* run_starts, uint count, uint end, ulong key, LOCAL uint* starts) {
    starts[TEAM_LANE] = key < count ? run_starts[key] : end;
    if (TEAM_LANE == TEAM_SIZE - 1u) starts[TEAM_SIZE] = key + 1u < count ? run_starts[key + 1u] : end;
}

// The run that contains `row`.
DEVICE uint run_of(LOCAL const uint* starts, uint row) {
    uint low = 0;
    uint high = TEAM_SIZE;
    while (high - low > 1u) {
        const uint middle = (low + high) / 2u;
        if (starts[middle] <= row)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Number of the keys of a quad that are less than `key`.
DEVICE uint less_in_quad(WordRow quad, uint key) {
    return (quad.x < key ? 1u : 0u) + (quad.y < key ? 1u : 0u) + (quad.z < key ? 1u : 0u)
           + (quad.w < key ? 1u : 0u);
}

// The same of those in rows first..end - 1. `at`: the quad's first row.
DEVICE uint less_in_part(WordRow quad, uint key, uint at, uint first, uint end) {
    uint less = quad.x < key && at >= first ? 1u : 0u;
    less += quad.y < key && at + 1u >= first && at + 1u < end ? 1u : 0u;
    less += quad.z < key && at + 2u >= first && at + 2u < end ? 1u : 0u;
    return less + (quad.w < key && at + 3u < end ? 1u : 0u);
}

// The place of a row in its run, which is not too long. Reads the keys in aligned quads, of which the buffer
// has whole ones.
DEVICE uint ranked_place(GLOBAL const uint* keys, uint first, uint end, uint row) {
    GLOBAL const WordRow* quads = (GLOBAL const WordRow*)keys;
    const uint key = keys[row];
    const uint first_quad = first / 4u;
    const uint last_quad = (end - 1u) / 4u;
    uint place = first + less_in_part(quads[first_quad], key, 4u * first_quad, first, end);
    for (uint quad = first_quad + 1u; quad < last_quad; ++quad) place += less_in_quad(quads[quad], key);
    if (last_quad > first_quad) place += less_in_part(quads[last_quad], key, 4u * last_quad, first, end);
    return place;
}

// Writes row `at` of the pairs from the places of a and b. `solids`: by place, the words of a tetrahedron in
// pairs: its slot, or its body and its position there.
DEVICE void write_solids(GLOBAL uint* found, uint at, GLOBAL const uint* solids, uint a, uint b) {
    if (PAIR_LAYOUT == PAIR_SLOTS) {
        const WordPair pair = {solids[a], solids[b]};
        ((GLOBAL WordPair*)found)[at] = pair;
    } else {
        const WordPair first = ((GLOBAL const WordPair*)solids)[a];
        const WordPair second = ((GLOBAL const WordPair*)solids)[b];
        const WordRow pair = {first.x, second.x, first.y, second.y};
        ((GLOBAL WordRow*)found)[at] = pair;
    }
}

// Sorts the run of each of `count` keys, and writes it to `found`.
KERNEL void sort_pairs(GLOBAL const uint* run_starts, uint count, uint capacity, GLOBAL uint* keys,
                       GLOBAL const uint* solids, GLOBAL uint* found, GLOBAL const uint* status) {
    LOCAL_ARRAY(uint, all_starts, TEAM_COUNT * STARTS);
    LOCAL uint* starts = all_starts + TEAM_ID * STARTS;
    ulong key = GLOBAL_ID;
    ulong first_of_group = GROUP_ID * (ulong)GROUP_SIZE;
    do { // runs at least once, as loops with barriers must
        load_starts(run_starts, count, rows_in(status + STATUS_PAIRS, capacity), key, starts);
        TEAM_BARRIER;
        const uint first_key = (uint)key - TEAM_LANE;
        for (ulong i = (ulong)starts[0] + TEAM_LANE; i < starts[TEAM_SIZE]; i += TEAM_SIZE) {
            const uint row = (uint)i; // `i` has more bits, because a sum of 32 might wrap around
            const uint run = run_of(starts, row);
            const uint first = starts[run];
            const uint end = starts[run + 1u];
            if (end - first <= MOST_RANKED)
                write_solids(found, ranked_place(keys, first, end, row), solids, first_key + run, keys[row]);
        }
        const uint first = starts[TEAM_LANE];
        const uint end = starts[TEAM_LANE + 1u];
        if (end - first > MOST_RANKED) {
            sort_run(keys, first, end);
            for (uint row = first; row < end; ++row) write_solids(found, row, solids, (uint)key, keys[row]);
        }
        TEAM_BARRIER;
        key += GLOBAL_COUNT;
        first_of_group += GLOBAL_COUNT;
    } while (first_of_group < count);
}

// Copies each contact to its place: `starts` has that of the first contact of each pair.
KERNEL void place_contacts(GLOBAL const uint* contact_ids, GLOBAL const real* contact_values, uint capacity,
                           uint reduced, GLOBAL const uint* masks, GLOBAL const uint* starts,
                           GLOBAL uint* sorted_ids, GLOBAL real* sorted_values, GLOBAL const uint* status) {
    const uint count = contacts_in(status, capacity, reduced);
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        const WordPair contact = ((GLOBAL const WordPair*)contact_ids)[i];
        const WordPair mask = ((GLOBAL const WordPair*)masks)[contact.x];
        const uint below = (1u << contact.y % 32u) - 1u;
        const ulong at = (ulong)starts[contact.x]
                         + (contact.y % 64u < 32u ? COUNT_ONES(mask.x & below)
                                                  : COUNT_ONES(mask.x) + COUNT_ONES(mask.y & below));
        ((GLOBAL WordPair*)sorted_ids)[at] = contact;
        GLOBAL const RealRow* values = (GLOBAL const RealRow*)contact_values + 2 * i;
        GLOBAL RealRow* sorted = (GLOBAL RealRow*)sorted_values + 2 * at;
        sorted[0] = values[0];
        sorted[1] = values[1];
    }
}
