// SPDX-License-Identifier: MIT
// The first of three kernels from candidate pairs to contacts: what can be said of a pair at little cost.
#include "backends/portable.h"

#include "algorithms/narrow_phase/trial.clh"
#include "algorithms/narrow_phase/waiting.clh"

// How many pairs a work-item takes before its group hands out what it has found: every time the group meets.
#define PAIRS_AT_A_TIME 4
#define FOUND_CAPACITY (PAIRS_AT_A_TIME * GROUP_SIZE)

// Puts what a group has found at the ends of the lists; the whole group comes here.
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
    BARRIER;
}

// Of pairs first..`pair_capacity` - 1, at most OPEN_PAIRS of them, as far as the status counts so many.
// `verdicts` are read when DECIDED only; a pair that is not known to be apart then counts as one that meets.
KERNEL void certify_pairs(GLOBAL const uint* found, uint first, uint pair_capacity, GLOBAL const uint* owners,
                          GLOBAL const real* poses, GLOBAL const uint* tetrahedra,
                          GLOBAL const real* vertices, GLOBAL const uchar* boundary,
                          GLOBAL const uchar* verdicts, GLOBAL uint* open, GLOBAL uint* meeting,
                          GLOBAL uint* status) {
    LOCAL_ARRAY(uint, group, GROUP_WORDS);
    LOCAL_ARRAY(uint, waiting, LISTS * FOUND_CAPACITY);
    const Candidates all = {found, owners, poses, tetrahedra, vertices, boundary};
    const ulong count = stored(status + STATUS_PAIRS, pair_capacity);
    ulong start = (ulong)first + GROUP_ID * (uint)GROUP_SIZE;
    begin_group(group);
    do {
        NO_UNROLL for (int i = 0; i < PAIRS_AT_A_TIME; ++i, start += GLOBAL_COUNT) {
            const uint index = (uint)(start + LOCAL_ID);
            int edge = -1;
            if (start + LOCAL_ID >= count) continue;
            const int apart = DECIDED && verdicts[index] == VERDICT_APART;
            const int state = apart ? REJECTED : try_certificate(&all, index, &edge);
            count_state(state, group);
            if (state == OPEN)
                waiting[LIST_OPEN * FOUND_CAPACITY + LOCAL_ATOMIC_ADD(group + LIST_OPEN, 1u)] =
                    OPEN_PAIR(index - first, edge);
            if (state == MEETING && !has_no_normal(&all, index))
                waiting[LIST_MEETING * FOUND_CAPACITY + LOCAL_ATOMIC_ADD(group + LIST_MEETING, 1u)] = index;
        }
        hand_out(waiting, group, open, meeting, status);
    } while (start < count);
    end_group(group, status);
}
