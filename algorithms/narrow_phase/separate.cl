// SPDX-License-Identifier: MIT
// The second of three kernels from candidate pairs to contacts: tests the pairs that certificates leave open.
// Host variants: PRECISION, in lanes
#define IN_PACKS
#include "backends/portable.h"

#include "algorithms/narrow_phase/pair_state.clh"
#include "algorithms/narrow_phase/pair_lists.clh"

// `first`: that of certify_pairs; the words of `open` are relative to it. `verdicts` are as in KNOWN_APART;
// with DECIDED, pairs not known to be apart count as meeting.
KERNEL void separate_pairs(GLOBAL const uint* found, uint first, GLOBAL const uint* owners,
                           GLOBAL const real* poses, GLOBAL const uint* tetrahedra,
                           GLOBAL const real* vertices, GLOBAL const uchar* verdicts, GLOBAL const uint* open,
                           GLOBAL uint* meeting, GLOBAL uint* near, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, group, GROUP_WORDS);
    LOCAL_ARRAY(LocalPair, pairs, GROUP_SIZE);
    const Candidates all = {found, owners, poses, tetrahedra, vertices, 0};
    const uint count = status[STATUS_WAITING + LIST_OPEN];
    uint start = (GROUP_ID * (uint)GROUP_SIZE) * PACK;
    begin_group(group);
    do {
        uints state = SAME_WORD(PAIR_ABSENT);
        uints index = SAME_WORD(0);
        const uint base = start + LOCAL_ID * PACK;
        const uint present = elements_below(base, count);
        if (present != 0u) {
            const uints word = entries_of(open, base, present);
            index = first + PAIR_OF_OPEN(word);
            const flags apart = known_apart(verdicts, index);
            state = SAME_WORD(PAIR_APART);
            if (!ALL(apart))
                state =
                    apart ? state : try_all(&all, index, NOT(apart), EDGE_OF_OPEN(word), pairs + LOCAL_ID);
            state = first_elements(present) ? state : SAME_WORD(PAIR_ABSENT);
        }
        count_state(state, group);
        uint slot = local_index(LIST_MEETING, COUNT_FLAGS(state == (uint)PAIR_MEETING), group, status);
        FOR_PACK(element) {
            if (AT(state, element) == PAIR_MEETING) meeting[slot++] = (uint)AT(index, element);
        }
        if (WANTS_NEAR) {
            slot = local_index(LISTS - 1, COUNT_FLAGS(state == (uint)PAIR_NEAR), group, status);
            FOR_PACK(element) {
                if (AT(state, element) == PAIR_NEAR) near[slot++] = (uint)AT(index, element);
            }
        }
        start += GLOBAL_COUNT * PACK;
    } while (start < count);
    end_group(group, status);
}
