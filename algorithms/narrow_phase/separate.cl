// SPDX-License-Identifier: MIT
// The second of three kernels from candidate pairs to contacts: the tests of pairs of which no certificate
// tells whether they meet.
#include "backends/portable.h"

#include "algorithms/narrow_phase/trial.clh"
#include "algorithms/narrow_phase/waiting.clh"

// `first`: that of certify_pairs, which the words of `open` are counted from. `verdicts` are read when
// DECIDED only; a pair that is not known to be apart then counts as one that meets.
KERNEL void separate_pairs(GLOBAL const uint* found, uint first, GLOBAL const uint* owners,
                           GLOBAL const real* poses, GLOBAL const uint* tetrahedra,
                           GLOBAL const real* vertices, GLOBAL const uchar* boundary,
                           GLOBAL const uchar* verdicts, GLOBAL const uint* open, GLOBAL uint* meeting,
                           GLOBAL uint* status) {
    LOCAL_ARRAY(uint, group, GROUP_WORDS);
    const Candidates all = {found, owners, poses, tetrahedra, vertices, boundary};
    const uint count = status[STATUS_WAITING + LIST_OPEN];
    uint start = GROUP_ID * (uint)GROUP_SIZE;
    begin_group(group);
    do {
        int state = STEPPED;
        uint index = 0;
        int has_normal = 0;
        if (start + LOCAL_ID < count) {
            const uint word = open[start + LOCAL_ID];
            index = first + PAIR_OF_OPEN(word);
            // Asked before the tests: who they are would otherwise be kept through them, and the registers
            // are few.
            has_normal = !has_no_normal(&all, index);
            const int apart = DECIDED && verdicts[index] == VERDICT_APART;
            state = apart ? REJECTED : try_all(&all, index, EDGE_OF_OPEN(word));
        }
        count_state(state, group);
        const int meets = state == MEETING && has_normal;
        const uint place = local_index(meets ? LIST_MEETING : NO_LIST, group, status);
        if (meets) meeting[place] = index;
        start += GLOBAL_COUNT;
    } while (start < count);
    end_group(group, status);
}
