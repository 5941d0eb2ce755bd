// SPDX-License-Identifier: MIT
// The second of three kernels from candidate pairs to contacts: tests the pairs that certificates leave open.
// Host variants: PRECISION
#include "backends/portable.h"

#include "algorithms/narrow_phase/pair_state.clh"
#include "algorithms/narrow_phase/pair_lists.clh"

// `first`: that of certify_pairs; the words of `open` are relative to it. `verdicts` are as in KNOWN_APART;
// with DECIDED, pairs not known to be apart count as meeting.
KERNEL void separate_pairs(GLOBAL const uint* found, uint first, GLOBAL const uint* owners,
                           GLOBAL const real* poses, GLOBAL const uint* tetrahedra,
                           GLOBAL const real* vertices, GLOBAL const uchar* verdicts, GLOBAL const uint* open,
                           GLOBAL uint* meeting, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, group, GROUP_WORDS);
    LOCAL_ARRAY(LocalPair, pairs, GROUP_SIZE);
    const Candidates all = {found, owners, poses, tetrahedra, vertices, 0};
    const uint count = status[STATUS_WAITING + LIST_OPEN];
    uint start = GROUP_ID * (uint)GROUP_SIZE;
    begin_group(group);
    do {
        int state = PAIR_ABSENT;
        uint index = 0;
        if (start + LOCAL_ID < count) {
            const uint word = open[start + LOCAL_ID];
            index = first + PAIR_OF_OPEN(word);
            const int apart = KNOWN_APART(verdicts, index);
            state = apart ? PAIR_REJECTED : try_all(&all, index, EDGE_OF_OPEN(word), pairs + LOCAL_ID);
        }
        count_state(state, group);
        const uint slot = local_index(state == PAIR_MEETING ? LIST_MEETING : NO_LIST, group, status);
        if (state == PAIR_MEETING) meeting[slot] = index;
        start += GLOBAL_COUNT;
    } while (start < count);
    end_group(group, status);
}
