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
#define PAIRS_AT_A_TIME (8 * PACK)
#define FOUND_CAPACITY (PAIRS_AT_A_TIME * GROUP_SIZE)
#define GROUP_ASKED GROUP_OWN // number of pairs in `asked`

// Appends a group's results to the lists. The whole group must call it.
DEVICE void hand_out(LOCAL const uint* found, LOCAL uint* group, GLOBAL uint* open, GLOBAL uint* meeting,
                     GLOBAL uint* status) {
    BARRIER;
    for (uint i = LOCAL_ID; i < LISTS; i += GROUP_SIZE)
        group[GROUP_PLACES + i] = group[i] != 0u ? ATOMIC_ADD(status + STATUS_WAITING + i, group[i]) : 0u;
    BARRIER;
    for (uint i = LOCAL_ID; i < group[LIST_OPEN]; i += GROUP_SIZE)
        open[group[GROUP_PLACES + LIST_OPEN] + i] = found[LIST_OPEN * FOUND_CAPACITY + i];
    for (uint i = LOCAL_ID; i < group[LIST_MEETING]; i += GROUP_SIZE)
        meeting[group[GROUP_PLACES + LIST_MEETING] + i] = found[LIST_MEETING * FOUND_CAPACITY + i];
    BARRIER;
    for (uint i = LOCAL_ID; i < LISTS; i += GROUP_SIZE) group[i] = 0u;
    if (LOCAL_ID == 0u) group[GROUP_ASKED] = 0u;
    BARRIER;
}

// Lists pairs base..base + count - 1 that have the boundary faces that the rule needs, and counts the others.
DEVICE void ask(const Candidates* all, uint base, uint count, LOCAL uint* asked, LOCAL uint* group) {
#if PACK > 1
    uint entry = group[GROUP_ASKED];
    const uint before = entry;
    for (uint i = 0; i < count; ++i) { // without a branch, because none would be foreseen
        asked[entry] = base + i;
        entry += 1u - lacks_boundary(all, base + i);
    }
    group[GROUP_ASKED] = entry;
    group[GROUP_WITHOUT] += count - (entry - before);
#else
    if (count == 0u) return;
    if (lacks_boundary(all, base) != 0u)
        LOCAL_ATOMIC_ADD(group + GROUP_WITHOUT, 1u);
    else
        asked[LOCAL_ATOMIC_ADD(group + GROUP_ASKED, 1u)] = base;
#endif
}

// Processes pairs first..`pair_capacity` - 1, at most OPEN_PAIRS of them, up to the count in the status.
// `verdicts` are as in KNOWN_APART; with DECIDED, pairs not known to be apart count as meeting.
KERNEL void certify_pairs(GLOBAL const uint* found, uint first, uint pair_capacity, GLOBAL const uint* owners,
                          GLOBAL const real* poses, GLOBAL const uint* tetrahedra,
                          GLOBAL const real* vertices, GLOBAL const uchar* boundary,
                          GLOBAL const uchar* verdicts, GLOBAL uint* open, GLOBAL uint* meeting,
                          GLOBAL uint* status) {
    LOCAL_ARRAY(uint, group, GROUP_WORDS);
    LOCAL_ARRAY(uint, asked, FOUND_CAPACITY);
    LOCAL_ARRAY(uint, waiting, LISTS * FOUND_CAPACITY);
    const Candidates all = {found, owners, poses, tetrahedra, vertices, boundary};
    const ulong count = rows_in(status + STATUS_PAIRS, pair_capacity);
    ulong start = (ulong)first + (GROUP_ID * (uint)GROUP_SIZE) * PACK;
    begin_group(group);
    do {
        NO_UNROLL for (int i = 0; i < PAIRS_AT_A_TIME / PACK; ++i, start += GLOBAL_COUNT * PACK) {
            const ulong base = start + LOCAL_ID * PACK;
            ask(&all, (uint)base, elements_below(base, count), asked, group);
        }
        BARRIER;
        NO_UNROLL for (uint i = LOCAL_ID * PACK; i < group[GROUP_ASKED]; i += GROUP_SIZE * PACK) {
            const uint present = elements_below(i, group[GROUP_ASKED]);
            uints index = SAME_WORD(0);
            FOR_PACK(element) AT(index, element) = asked[i + (element < present ? element : 0u)];
            uints edge = SAME_WORD(0);
            const flags apart = known_apart(verdicts, index);
            uints state = SAME_WORD(PAIR_REJECTED);
            if (!ALL(apart)) state = apart ? state : try_certificate(&all, index, &edge);
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
        }
        hand_out(waiting, group, open, meeting, status);
    } while (start < count);
    end_group(group, status);
}
