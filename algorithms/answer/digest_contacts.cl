// SPDX-License-Identifier: MIT
// The digest of contacts; algorithms/answer/README.md describes that of pairs.
// Host variants: PRECISION
#include "backends/portable.h"

#include "algorithms/answer/pairs.clh"
#include "algorithms/bodies/body.clh"
#include "algorithms/answer/contact_rows.clh"

// The term of a contact in the digest: that of its pair, then the feature, then the bits of its reals, two
// words at a time.
DEVICE ulong contact_term(ulong pair_term, uint feature, GLOBAL const uint* bits) {
    ulong term = mix(pair_term + feature);
    for (int i = 0; i < CONTACT_BITS; i += 2) term = mix(term + (((ulong)bits[i + 1] << 32) | bits[i]));
    return term;
}

// Adds the terms of the first `count` contacts to `sums`. `value_bits`: their values as words. `ids`: input
// numbers of bodies and tetrahedra.
KERNEL void digest_contacts(GLOBAL const uint* found, GLOBAL const uint* owners, GLOBAL const uint* ids,
                            GLOBAL const uint* contact_ids, GLOBAL const uint* value_bits, uint count,
                            GLOBAL uint* sums) {
    ulong a = 0;
    ulong b = 0;
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        GLOBAL const uint* contact = contact_ids + i * CONTACT_WORDS;
        const PairMembers pair = members_of(found, contact[0], owners);
        const ulong term = contact_term(term_of(&pair, ids), contact[1], value_bits + i * CONTACT_BITS);
        a += term;
        b += digest_b(term);
    }
    add_to_sums(sums, a, b);
}
