// SPDX-License-Identifier: MIT
// The end of a frame that the host does not wait for.
// Host variants: PRECISION
#include "backends/portable.h"
#include "algorithms/answer/pairs.clh"
#include "algorithms/answer/queued.clh"

// Writes the pairs in `found` as expand_pairs does.
KERNEL void name_pairs(GLOBAL const uint* found, uint capacity, GLOBAL const uint* owners,
                       GLOBAL const uint* ids, GLOBAL uint* expanded, GLOBAL const uint* status) {
    const uint rows = rows_in(status + STATUS_PAIRS, capacity);
    for (ulong i = GLOBAL_ID; i < rows; i += GLOBAL_COUNT) { // 32 bits might wrap around
        const PairMembers pair = members_of(found, i, owners);
        ((GLOBAL WordRow*)expanded)[i] = named(&pair, ids);
    }
}

DEVICE void copy_counter(GLOBAL uint* to, GLOBAL const uint* from) {
    to[0] = from[0];
    to[1] = from[1];
}

// Writes the counts of queued.clh. `limits`: rows of two words, the number of a counter in the status and the
// most that it may have counted. One group does it.
KERNEL void end_frame(GLOBAL const uint* limits, uint limit_count, GLOBAL const uint* status,
                      GLOBAL uint* counts) {
    for (uint i = GLOBAL_ID; i < (uint)STATUS_WORDS; i += GLOBAL_COUNT) counts[QUEUED_WORDS + i] = status[i];
    if (GLOBAL_ID != 0u) return;
    uint flag = 0;
    for (uint i = 0; i < limit_count; ++i) {
        GLOBAL const uint* counter = status + limits[2u * i];
        if (counter[1] != 0u || counter[0] > limits[2u * i + 1u]) flag |= QUEUED_NO_ROOM;
    }
    if ((status[STATUS_FLAWED] | status[STATUS_FLAWED_HIGH]) != 0u) flag |= QUEUED_FLAWED;
    for (uint i = 0; i < EXCEEDED_WORDS; ++i)
        if (status[STATUS_EXCEEDED + i] != 0u) flag |= QUEUED_EXCEEDED;
    counts[QUEUED_FLAG] = flag;
    counts[QUEUED_FLAG + 1] = 0;
    copy_counter(counts + QUEUED_PAIRS, status + STATUS_PAIRS);
    copy_counter(counts + QUEUED_CONTACTS, status + STATUS_CONTACTS);
    copy_counter(counts + QUEUED_BODY_PAIRS, status + STATUS_BODY_PAIRS);
    copy_counter(counts + QUEUED_DIGEST_A, status + STATUS_DIGEST_A);
    copy_counter(counts + QUEUED_DIGEST_B, status + STATUS_DIGEST_B);
}
