// SPDX-License-Identifier: MIT
// The digest of candidate pairs that lie in a buffer.
#include "backends/portable.h"
#include "algorithms/answer/pairs.clh"

// Adds the terms of the first `count` rows to `sums`.
KERNEL void digest_pairs(GLOBAL const uint* found, uint count, GLOBAL const uint* bodies,
                         GLOBAL const uint* ids, GLOBAL uint* sums) {
    Tally tally = empty_tally();
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) { // of 64 bits, or it would start over near 2^32
        GLOBAL const uint* pair = found + i * PAIR_WORDS;
        tally_digest(&tally, bodies, ids, pair[0], pair[1], pair[2], pair[3]);
    }
    add_to_sums(sums, tally.a, tally.b);
}
