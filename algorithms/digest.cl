// SPDX-License-Identifier: MIT
// The digest of candidate pairs that lie in a buffer.
#include "backends/portable.h"
#include "algorithms/pairs.clh"

KERNEL void digest_pairs(GLOBAL const uint* found, uint capacity, GLOBAL const uint* bodies,
                         GLOBAL const uint* ids, GLOBAL uint* status) {
    Tally tally = empty_tally();
    const uint count =
        status[STATUS_PAIRS + 1] != 0u || status[STATUS_PAIRS] > capacity ? capacity : status[STATUS_PAIRS];
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) { // of 64 bits, or it would start over near 2^32
        GLOBAL const uint* pair = found + i * PAIR_WORDS;
        tally_digest(&tally, bodies, ids, pair[0], pair[1], pair[2], pair[3]);
    }
    if (tally.a != 0 || tally.b != 0) {
        counter_add_wide(status + STATUS_DIGEST_A, tally.a);
        counter_add_wide(status + STATUS_DIGEST_B, tally.b);
    }
}
