// SPDX-License-Identifier: MIT
// The first of three kernels from candidate pairs to contacts: leaves out pairs without the boundary faces
// that the rule needs, and decides the others by certificates, at little cost.
// Host variants: PRECISION, in lanes
#define IN_PACKS
#include "backends/portable.h"

#include "algorithms/narrow_phase/pair_state.clh"
#include "algorithms/narrow_phase/pair_lists.clh"

// Pairs per work-item between two writes of its group's results, each of which needs barriers. Where many
// pairs lack boundary faces, enough others remain for all work-items.
#define READ_AT_ONCE 4
#define READS 2
#define PAIRS_AT_A_TIME (READS * READ_AT_ONCE * PACK)
// The pairs of all work-items, and fewer than one for each that wait for more.
#define ROUND_PAIRS (GROUP_SIZE * PACK)
#define FOUND_CAPACITY ((PAIRS_AT_A_TIME + PACK) * GROUP_SIZE)

// Appends a group's results to the lists. The whole group must call it.
DEVICE void hand_out(LOCAL const uint* found, LOCAL uint* group, GLOBAL uint* open, GLOBAL uint* meeting,
                     GLOBAL uint* near, GLOBAL uint* status) {
    BARRIER;
    for (uint i = LOCAL_ID; i < LISTS; i += GROUP_SIZE)
        group[GROUP_PLACES + i] = group[i] != 0u ? ATOMIC_ADD(status + STATUS_WAITING + i, group[i]) : 0u;
    BARRIER;
    for (uint i = LOCAL_ID; i < group[LIST_OPEN]; i += GROUP_SIZE)
        open[group[GROUP_PLACES + LIST_OPEN] + i] = found[LIST_OPEN * FOUND_CAPACITY + i];
    for (uint i = LOCAL_ID; i < group[LIST_MEETING]; i += GROUP_SIZE)
        meeting[group[GROUP_PLACES + LIST_MEETING] + i] = found[LIST_MEETING * FOUND_CAPACITY + i];
    for (uint i = LOCAL_ID; WANTS_NEAR && i < group[LISTS - 1]; i += GROUP_SIZE)
        near[group[GROUP_PLACES + LISTS - 1] + i] = found[(LISTS - 1) * FOUND_CAPACITY + i];
    BARRIER;
    for (uint i = LOCAL_ID; i < LISTS; i += GROUP_SIZE) group[i] = 0u;
}

// Moves pairs from `done` on, fewer than ROUND_PAIRS, to the front of `asked`. The whole group must call it.
DEVICE void keep_rest(uint done, LOCAL uint* asked, LOCAL uint* group) {
    const uint rest = group[GROUP_ASKED] - done;
    BARRIER;
    if (done != 0u)
        for (uint i = LOCAL_ID; i < rest; i += GROUP_SIZE) asked[i] = asked[done + i];
    if (LOCAL_ID == 0u) group[GROUP_ASKED] = rest;
    BARRIER;
}

// Lists those of READ_AT_ONCE packs of pairs that have the boundary faces that the rule needs, and counts the
// others. `base`: the first pair of the first pack; packs are ROUND_PAIRS apart.
DEVICE void ask(const Candidates* all, ulong base, ulong count, LOCAL uint* asked, LOCAL uint* group) {
#if PACK > 1
    uint entry = group[GROUP_ASKED];
    for (uint pack = 0; pack < READ_AT_ONCE; ++pack, base += ROUND_PAIRS) {
        const uint present = elements_below(base, count);
        const uint before = entry;
        for (uint i = 0; i < present; ++i) { // without a branch, because none would be foreseen
            asked[entry] = (uint)base + i;
            entry += 1u - is_without_contact(all, (uint)base + i);
        }
        group[GROUP_LEFT_OUT] += present - (entry - before);
    }
    group[GROUP_ASKED] = entry;
#else
    if (base >= count) return;
    uint present = 0;
    uint lacking = 0; // one bit for each pair: all are read before any is listed
    UNROLL for (uint i = 0; i < READ_AT_ONCE; ++i) {
        const ulong index = base + i * GROUP_SIZE;
        const flags is_one = index < count;
        present += BIT(is_one);
        lacking |= is_without_contact(all, (uint)(is_one ? index : base)) << i;
    }
    const uint without = COUNT_ONES(lacking & ((1u << present) - 1u));
    if (without != 0u) LOCAL_ATOMIC_ADD(group + GROUP_LEFT_OUT, without);
    uint entry = without < present ? LOCAL_ATOMIC_ADD(group + GROUP_ASKED, present - without) : 0u;
    UNROLL for (uint i = 0; i < READ_AT_ONCE; ++i) {
        if (i < present && (lacking >> i & 1u) == 0u) asked[entry++] = (uint)(base + i * GROUP_SIZE);
    }
#endif
}

// Processes pairs first..`pair_capacity` - 1, at most OPEN_PAIRS of them, up to the count in the status.
// `verdicts` are as in KNOWN_APART; with DECIDED, pairs not known to be apart count as meeting. `margin` and
// `near`: read and written only for rules that want near pairs.
KERNEL void certify_pairs(GLOBAL const uint* found, uint first, uint pair_capacity, GLOBAL const uint* owners,
                          GLOBAL const real* poses, GLOBAL const uint* tetrahedra,
                          GLOBAL const real* vertices, GLOBAL const uchar* boundary,
                          GLOBAL const uchar* verdicts, float margin, GLOBAL uint* open, GLOBAL uint* meeting,
                          GLOBAL uint* near, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, group, GROUP_WORDS);
    LOCAL_ARRAY(uint, asked, FOUND_CAPACITY);
    LOCAL_ARRAY(uint, waiting, LISTS * FOUND_CAPACITY);
    const Candidates all = {found, owners, poses, tetrahedra, vertices, boundary};
    const ulong count = rows_in(status + STATUS_PAIRS, pair_capacity);
    // A group's pairs lie together, because the walk found them together: they share tetrahedra.
    ulong start = (ulong)first + (GROUP_ID * (uint)GROUP_SIZE) * PAIRS_AT_A_TIME;
    begin_group(group);
    do {
        NO_UNROLL for (uint i = 0; i < READS; ++i)
            ask(&all, start + i * READ_AT_ONCE * ROUND_PAIRS + LOCAL_ID * PACK, count, asked, group);
        start += PAIRS_AT_A_TIME * GLOBAL_COUNT;
        BARRIER;
        const uint rest = start < count ? group[GROUP_ASKED] % ROUND_PAIRS : 0u;
        const uint end = group[GROUP_ASKED] - rest;
        NO_UNROLL for (uint i = LOCAL_ID * PACK; i < end; i += ROUND_PAIRS) {
            const uint present = elements_below(i, end);
            uints index = SAME_WORD(0);
            FOR_PACK(element) AT(index, element) = asked[i + (element < present ? element : 0u)];
            uints edge = SAME_WORD(0);
            const flags apart = known_apart(verdicts, index);
            uints state = SAME_WORD(PAIR_REJECTED);
            if (WANTS_NEAR || !ALL(apart)) state = try_certificate(&all, index, apart, margin, &edge);
            state = first_elements(present) ? state : SAME_WORD(PAIR_ABSENT);
            count_state(state, group);
            FOR_PACK(element) {
                const uint one = (uint)AT(index, element);
                APPEND_IF(AT(state, element) == PAIR_OPEN, group + LIST_OPEN,
                          waiting[LIST_OPEN * FOUND_CAPACITY + entry] =
                              OPEN_PAIR(one - first, (uint)AT(edge, element)));
                APPEND_IF(AT(state, element) == PAIR_MEETING, group + LIST_MEETING,
                          waiting[LIST_MEETING * FOUND_CAPACITY + entry] = one);
            }
            if (WANTS_NEAR) FOR_PACK(element) {
                    const uint one = (uint)AT(index, element);
                    APPEND_IF(AT(state, element) == PAIR_NEAR, group + LISTS - 1,
                              waiting[(LISTS - 1) * FOUND_CAPACITY + entry] = one);
                }
        }
        hand_out(waiting, group, open, meeting, near, status);
        keep_rest(end, asked, group);
    } while (start < count);
    end_group(group, status);
}
