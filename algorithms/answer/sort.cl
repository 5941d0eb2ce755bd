// SPDX-License-Identifier: MIT
// Canonical order of an answer: pairs by the numbers of their bodies and tetrahedra, contacts by pair and
// feature. Rows are counted by a first key, whose sums give each key its run of places. Rows go to places of
// their run in any order. The rank of a row's second key in its run is then its place. Runs are short: most
// have fewer than 32 rows. Second keys of a run differ.
#include "backends/portable.h"
#include "algorithms/answer/pairs.clh"

// Copies row `i` of a buffer of pairs to row `j` of another. The host has one build for both layouts.
DEVICE void copy_pair(GLOBAL uint* to, ulong j, GLOBAL const uint* from, ulong i) {
    if (PAIR_LAYOUT == PAIR_SLOTS)
        ((GLOBAL WordPair*)to)[j] = ((GLOBAL const WordPair*)from)[i];
    else
        ((GLOBAL WordRow*)to)[j] = ((GLOBAL const WordRow*)from)[i];
}

// Rows in a buffer of `capacity` rows with a 64-bit counter.
DEVICE uint rows_in(GLOBAL const uint* counter, uint capacity) {
    return counter[1] != 0u || counter[0] > capacity ? capacity : counter[0];
}

// Position of a tetrahedron in the order of the scene: `firsts` has that of each body's first tetrahedron.
DEVICE uint place_of(const BodyTetrahedron* one, GLOBAL const uint* firsts, GLOBAL const uint* ids) {
    return firsts[one->body] + tetrahedron_id(ids, one->tetrahedron);
}

// counts[place of a] += 1 for each pair.
KERNEL void count_pairs(GLOBAL const uint* found, uint capacity, GLOBAL const uint* owners,
                        GLOBAL const uint* ids, GLOBAL const uint* firsts, GLOBAL uint* counts,
                        GLOBAL const uint* status) {
    const uint rows = rows_in(status + STATUS_PAIRS, capacity);
    for (ulong i = GLOBAL_ID; i < rows; i += GLOBAL_COUNT) { // 32 bits might wrap around
        const PairMembers pair = members_of(found, i, owners);
        ATOMIC_ADD(counts + place_of(&pair.a, firsts, ids), 1u);
    }
}

// counts[pair] += 1 for each contact.
KERNEL void count_contacts(GLOBAL const uint* contact_ids, uint capacity, GLOBAL uint* counts,
                           GLOBAL const uint* status) {
    const uint rows = rows_in(status + STATUS_CONTACTS, capacity);
    for (ulong i = GLOBAL_ID; i < rows; i += GLOBAL_COUNT)
        ATOMIC_ADD(counts + ((GLOBAL const WordPair*)contact_ids)[i].x, 1u);
}

// The first of a work-group's part of `count` values.
DEVICE uint group_first(uint group, uint count) {
    const uint each = (count + GROUP_COUNT - 1u) / GROUP_COUNT;
    const ulong first = (ulong)group * each;
    return first < count ? (uint)first : count;
}

// A work-item's share of the sum of values first..end - 1: those a fixed stride apart.
DEVICE uint strided_sum(GLOBAL const uint* values, uint first, uint end) {
    uint sum = 0;
    for (uint i = first + LOCAL_ID; i < end; i += (uint)GROUP_SIZE) sum += values[i];
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
    own_sums[LOCAL_ID] = strided_sum(counts, group_first(GROUP_ID, count), group_first(GROUP_ID + 1u, count));
    BARRIER;
    if (LOCAL_ID != 0u) return;
    uint all = 0;
    for (uint i = 0; i < (uint)GROUP_SIZE; ++i) all += own_sums[i];
    sums[GROUP_ID] = all;
}

// Turns the counts into the first place of each key. Each work-item has adjacent counts of the group's part.
KERNEL void start_runs(GLOBAL uint* counts, uint most, uint by_pair, GLOBAL const uint* sums,
                       GLOBAL const uint* status) {
    LOCAL_ARRAY(uint, before, GROUP_SIZE); // shares of the sum of the parts before this one
    LOCAL_ARRAY(uint, starts, GROUP_SIZE);
    const uint count = keys_in(status, most, by_pair);
    const uint first = group_first(GROUP_ID, count);
    const uint end = group_first(GROUP_ID + 1u, count);
    const uint each = (end - first + (uint)GROUP_SIZE - 1u) / (uint)GROUP_SIZE;
    const uint own_first = end - first > LOCAL_ID * each ? first + LOCAL_ID * each : end;
    const uint own_end = end - own_first > each ? own_first + each : end;
    uint sum = 0;
    for (uint i = own_first; i < own_end; ++i) sum += counts[i];
    starts[LOCAL_ID] = sum;
    before[LOCAL_ID] = strided_sum(sums, 0u, GROUP_ID);
    BARRIER;
    if (LOCAL_ID == 0u) {
        uint start = 0;
        for (uint i = 0; i < (uint)GROUP_SIZE; ++i) start += before[i];
        for (uint i = 0; i < (uint)GROUP_SIZE; ++i) {
            const uint own = starts[i];
            starts[i] = start;
            start += own;
        }
    }
    BARRIER;
    uint start = starts[LOCAL_ID];
    for (uint i = own_first; i < own_end; ++i) {
        const uint own = counts[i];
        counts[i] = start;
        start += own;
    }
}

// Puts each pair at a place of its run; `places` then has the end of each run. `keys`: the places of b.
KERNEL void scatter_pairs(GLOBAL const uint* found, uint capacity, GLOBAL const uint* owners,
                          GLOBAL const uint* ids, GLOBAL const uint* firsts, GLOBAL uint* places,
                          GLOBAL uint* rows, GLOBAL uint* keys, GLOBAL const uint* status) {
    const uint count = rows_in(status + STATUS_PAIRS, capacity);
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        const PairMembers pair = members_of(found, i, owners);
        const uint at = ATOMIC_ADD(places + place_of(&pair.a, firsts, ids), 1u);
        copy_pair(rows, at, found, i);
        keys[at] = place_of(&pair.b, firsts, ids);
    }
}

// The same for contacts: their row numbers, with the features as keys.
KERNEL void scatter_contacts(GLOBAL const uint* contact_ids, uint capacity, GLOBAL uint* places,
                             GLOBAL uint* rows, GLOBAL uint* keys, GLOBAL const uint* status) {
    const uint count = rows_in(status + STATUS_CONTACTS, capacity);
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        const WordPair contact = ((GLOBAL const WordPair*)contact_ids)[i];
        const uint at = ATOMIC_ADD(places + contact.x, 1u);
        rows[at] = (uint)i;
        keys[at] = contact.y;
    }
}

DEVICE void swap_words(GLOBAL uint* words, ulong i, ulong j) {
    const uint word = words[i];
    words[i] = words[j];
    words[j] = word;
}

// Swaps two rows of `words` words each, and their keys.
DEVICE void swap_rows(GLOBAL uint* keys, GLOBAL uint* rows, uint words, uint i, uint j) {
    swap_words(keys, i, j);
    for (uint word = 0; word < words; ++word)
        swap_words(rows, (ulong)words * i + word, (ulong)words * j + word);
}

// Restores the heap of rows first..first + count - 1 below `node`.
DEVICE void sift(GLOBAL uint* keys, GLOBAL uint* rows, uint words, uint first, uint count, uint node) {
    while (2u * node + 1u < count) {
        uint child = 2u * node + 1u;
        if (child + 1u < count && keys[first + child + 1u] > keys[first + child]) ++child;
        if (keys[first + node] >= keys[first + child]) return;
        swap_rows(keys, rows, words, first + node, first + child);
        node = child;
    }
}

// Longer runs are sorted as a heap by one work-item: ranks take time with the square of a run's length.
#define MOST_RANKED 512u

// Sorts rows first..end - 1 by their keys.
DEVICE void sort_run(GLOBAL uint* keys, GLOBAL uint* rows, uint words, uint first, uint end) {
    const uint count = end - first;
    for (uint node = count / 2u; node > 0u; --node) sift(keys, rows, words, first, count, node - 1u);
    for (uint last = count - 1u; last > 0u; --last) {
        swap_rows(keys, rows, words, first, first + last);
        sift(keys, rows, words, first, last, 0u);
    }
}

// The runs of TEAM_SIZE adjacent keys, whose rows are adjacent too: run i has rows starts[i]..starts[i + 1] -
// 1.
#define STARTS (TEAM_SIZE + 1)

// Loads the runs of a team from key `key` - TEAM_LANE on; keys from `count` on have no rows.
DEVICE void load_starts(GLOBAL const uint* places, uint count, ulong key, LOCAL uint* starts) {
    if (TEAM_LANE == 0u)
        starts[0] = key == 0u || count == 0u ? 0u : places[key < count ? key - 1u : count - 1u];
    starts[TEAM_LANE + 1u] = count == 0u ? 0u : places[key < count ? key : count - 1u];
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

// The place of a row in its run, which is not too long.
DEVICE uint ranked_place(GLOBAL const uint* keys, uint first, uint end, uint row) {
    const uint key = keys[row];
    uint place = first;
    for (uint other = first; other < end; ++other) place += keys[other] < key ? 1u : 0u;
    return place;
}

// Sorts the run of each of `count` keys, and writes it to `found`.
KERNEL void sort_pairs(GLOBAL const uint* places, uint count, GLOBAL uint* rows, GLOBAL uint* keys,
                       GLOBAL uint* found) {
    LOCAL_ARRAY(uint, all_starts, TEAM_COUNT * STARTS);
    LOCAL uint* starts = all_starts + TEAM_ID * STARTS;
    ulong key = GLOBAL_ID;
    ulong first_of_group = GROUP_ID * (ulong)GROUP_SIZE;
    do { // runs at least once, as loops with barriers must
        load_starts(places, count, key, starts);
        TEAM_BARRIER;
        for (ulong i = (ulong)starts[0] + TEAM_LANE; i < starts[TEAM_SIZE];
             i += TEAM_SIZE) { // 32 bits might wrap
            const uint row = (uint)i;
            const uint run = run_of(starts, row);
            const uint first = starts[run];
            const uint end = starts[run + 1u];
            if (end - first <= MOST_RANKED) copy_pair(found, ranked_place(keys, first, end, row), rows, row);
        }
        const uint first = starts[TEAM_LANE];
        const uint end = starts[TEAM_LANE + 1u];
        if (end - first > MOST_RANKED) {
            sort_run(keys, rows, PAIR_WORDS, first, end);
            for (uint row = first; row < end; ++row) copy_pair(found, row, rows, row);
        }
        TEAM_BARRIER;
        key += GLOBAL_COUNT;
        first_of_group += GLOBAL_COUNT;
    } while (first_of_group < count);
}

typedef struct {
    GLOBAL const uint* contact_ids;
    GLOBAL const real* contact_values;
    GLOBAL uint* sorted_ids;
    GLOBAL real* sorted_values;
} ContactRows;

DEVICE void copy_contact(const ContactRows* contacts, uint to, uint from) {
    ((GLOBAL WordPair*)contacts->sorted_ids)[to] = ((GLOBAL const WordPair*)contacts->contact_ids)[from];
    GLOBAL const RealRow* values = (GLOBAL const RealRow*)contacts->contact_values + 2 * (ulong)from;
    GLOBAL RealRow* sorted = (GLOBAL RealRow*)contacts->sorted_values + 2 * (ulong)to;
    sorted[0] = values[0];
    sorted[1] = values[1];
}

// Sorts the run of each of the pairs, and copies the contacts in this order. A pair has few contacts.
KERNEL void sort_contacts(GLOBAL const uint* places, uint pair_capacity, GLOBAL const uint* rows,
                          GLOBAL const uint* keys, GLOBAL const uint* contact_ids,
                          GLOBAL const real* contact_values, GLOBAL uint* sorted_ids,
                          GLOBAL real* sorted_values, GLOBAL const uint* status) {
    LOCAL_ARRAY(uint, all_starts, TEAM_COUNT * STARTS);
    LOCAL uint* starts = all_starts + TEAM_ID * STARTS;
    const ContactRows contacts = {contact_ids, contact_values, sorted_ids, sorted_values};
    const uint count = rows_in(status + STATUS_PAIRS, pair_capacity);
    ulong key = GLOBAL_ID;
    ulong first_of_group = GROUP_ID * (ulong)GROUP_SIZE;
    do { // runs at least once, as loops with barriers must
        load_starts(places, count, key, starts);
        TEAM_BARRIER;
        for (ulong i = (ulong)starts[0] + TEAM_LANE; i < starts[TEAM_SIZE]; i += TEAM_SIZE) {
            const uint row = (uint)i;
            const uint run = run_of(starts, row);
            copy_contact(&contacts, ranked_place(keys, starts[run], starts[run + 1u], row), rows[row]);
        }
        TEAM_BARRIER;
        key += GLOBAL_COUNT;
        first_of_group += GLOBAL_COUNT;
    } while (first_of_group < count);
}

// Copies the sorted contacts back.
KERNEL void return_contacts(GLOBAL const uint* sorted_ids, GLOBAL const real* sorted_values, uint capacity,
                            GLOBAL uint* contact_ids, GLOBAL real* contact_values,
                            GLOBAL const uint* status) {
    const uint count = rows_in(status + STATUS_CONTACTS, capacity);
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        ((GLOBAL WordPair*)contact_ids)[i] = ((GLOBAL const WordPair*)sorted_ids)[i];
        ((GLOBAL RealRow*)contact_values)[2 * i] = ((GLOBAL const RealRow*)sorted_values)[2 * i];
        ((GLOBAL RealRow*)contact_values)[2 * i + 1] = ((GLOBAL const RealRow*)sorted_values)[2 * i + 1];
    }
}
