// SPDX-License-Identifier: MIT
// What is asked about candidate pairs that lie in a buffer: their digest, and which tetrahedra they are.
#include "backends/portable.h"
#include "algorithms/answer/pairs.clh"

// Adds the terms of the first `count` rows to `sums`.
KERNEL void digest_pairs(GLOBAL const uint* found, uint count, GLOBAL const uint* owners,
                         GLOBAL const uint* ids, GLOBAL uint* sums) {
    Tally tally = empty_tally();
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) { // of 64 bits, or it would start over near 2^32
        const Members pair = members_of(found, i, owners);
        tally_term(&tally, term_of(&pair, ids));
    }
    add_to_sums(sums, tally.a, tally.b);
}

// The rows first..first + count - 1 as four words each: body a, tetrahedron a, body b, tetrahedron b, in
// input order's numbers.
KERNEL void expand_pairs(GLOBAL const uint* found, uint first, uint count, GLOBAL const uint* owners,
                         GLOBAL const uint* ids, GLOBAL uint* expanded) {
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        const Members pair = members_of(found, first + i, owners);
        const WordRow row = {pair.a.body, ids[pair.a.tetrahedron], pair.b.body, ids[pair.b.tetrahedron]};
        ((GLOBAL WordRow*)expanded)[i] = row;
    }
}
