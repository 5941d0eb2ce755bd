// SPDX-License-Identifier: MIT
// Kernels over candidate pairs in a buffer: digest, ids in the scene, and number of pairs by body.
// Host variants: PRECISION
#include "backends/portable.h"
#include "algorithms/answer/pairs.clh"

// Adds the terms of the first `count` rows to `sums`.
KERNEL void digest_pairs(GLOBAL const uint* found, uint count, GLOBAL const uint* owners,
                         GLOBAL const uint* ids, GLOBAL uint* sums) {
    Tally tally = empty_tally();
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) { // 64 bits, because 32 overflow near 2^32
        const PairMembers pair = members_of(found, i, owners);
        tally_term(&tally, term_of(&pair, ids));
    }
    add_to_sums(sums, tally.a, tally.b);
}

// Writes rows first..first + count - 1 as four words each: body a, tetrahedron a, body b, tetrahedron b, with
// the scene's numbers.
KERNEL void expand_pairs(GLOBAL const uint* found, uint first, uint count, GLOBAL const uint* owners,
                         GLOBAL const uint* ids, GLOBAL uint* expanded) {
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        const PairMembers pair = members_of(found, first + i, owners);
        ((GLOBAL WordRow*)expanded)[i] = named(&pair, ids);
    }
}

// Rows of one work-item. Consecutive rows mostly have the same two bodies, so that few additions are atomic.
#define ROWS_AT_ONCE 64u

DEVICE void add_count(GLOBAL uint* counts, uint body, uint count) {
    if (count != 0u) counter_add(counts + body, count);
}

// Adds to counts[b] the number of rows that contain body b.
KERNEL void count_by_body(GLOBAL const uint* found, uint count, GLOBAL const uint* owners,
                          GLOBAL uint* counts) {
    for (ulong first = (ulong)GLOBAL_ID * ROWS_AT_ONCE; first < count;
         first += (ulong)GLOBAL_COUNT * ROWS_AT_ONCE) {
        const uint rows = count - first < ROWS_AT_ONCE ? (uint)(count - first) : ROWS_AT_ONCE;
        uint a = 0;
        uint b = 0;
        uint of_a = 0;
        uint of_b = 0;
        NO_UNROLL for (uint i = 0; i < rows; ++i) {
            const PairMembers pair = members_of(found, first + i, owners);
            if (pair.a.body != a) {
                add_count(counts, a, of_a);
                a = pair.a.body;
                of_a = 0;
            }
            if (pair.b.body != b) {
                add_count(counts, b, of_b);
                b = pair.b.body;
                of_b = 0;
            }
            ++of_a;
            ++of_b;
        }
        add_count(counts, a, of_a);
        add_count(counts, b, of_b);
    }
}
