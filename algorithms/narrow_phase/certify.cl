// SPDX-License-Identifier: MIT
// The first of three kernels from candidate pairs to contacts: leaves out pairs without the boundary faces
// that the rule needs, and decides the others by certificates, at little cost.
// Host variants: PRECISION
#include "backends/portable.h"

#include "algorithms/narrow_phase/pair_state.clh"
#include "algorithms/narrow_phase/pair_lists.clh"

// Pairs per work-item between two writes of its group's results, each of which needs barriers. Where many
// pairs lack boundary faces, enough others remain for all work-items.
#define PAIRS_AT_A_TIME 8
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
    const ulong count = stored(status + STATUS_PAIRS, pair_capacity);
    ulong start = (ulong)first + GROUP_ID * (uint)GROUP_SIZE;
    begin_group(group);
    do {
        NO_UNROLL for (int i = 0; i < PAIRS_AT_A_TIME; ++i, start += GLOBAL_COUNT) {
            const uint index = (uint)(start + LOCAL_ID);
            if (start + LOCAL_ID >= count) continue;
            if (lacks_boundary(&all, index))
                count_state(PAIR_WITHOUT_BOUNDARY, group);
            else
                asked[LOCAL_ATOMIC_ADD(group + GROUP_ASKED, 1u)] = index;
        }
        BARRIER;
        NO_UNROLL for (uint i = LOCAL_ID; i < group[GROUP_ASKED]; i += GROUP_SIZE) {
            const uint index = asked[i];
            int edge = -1;
            const int apart = KNOWN_APART(verdicts, index);
            const int state = apart ? PAIR_REJECTED : try_certificate(&all, index, &edge);
            count_state(state, group);
            if (state == PAIR_OPEN)
                waiting[LIST_OPEN * FOUND_CAPACITY + LOCAL_ATOMIC_ADD(group + LIST_OPEN, 1u)] =
                    OPEN_PAIR(index - first, edge);
            if (state == PAIR_MEETING)
                waiting[LIST_MEETING * FOUND_CAPACITY + LOCAL_ATOMIC_ADD(group + LIST_MEETING, 1u)] = index;
        }
        hand_out(waiting, group, open, meeting, status);
    } while (start < count);
    end_group(group, status);
}
