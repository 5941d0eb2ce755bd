// SPDX-License-Identifier: MIT
// The certified filter in the cell's precision: a verdict for every pair that has the boundary faces that the
// contact rule needs, and a list of those it cannot decide. Each pair first gets a certificate, from this
// kernel or, with OVER_OPEN, from certify_pairs before it.
// Host variants: PRECISION, in lanes
#define IN_PACKS
#include "backends/portable.h"

#define CERTAIN_IN_DOUBLE 0
#include "algorithms/narrow_phase/certainty.clh"
#include "algorithms/narrow_phase/certificate.clh"
#include "algorithms/narrow_phase/open_pairs.clh"

// 1: only the pairs in the list `open`, whose words are relative to `first`.
#ifndef OVER_OPEN
#define OVER_OPEN 0
#endif

DEVICE uints filtered(const Candidates* all, uints index) {
    Points a[4];
    Points b[4];
    load_pair(all, index, a, b, 0);
    if (OVER_OPEN) return certain_verdict(a, b, ALWAYS);
    const uints certain = certificate_of(a, b);
    const flags open = certain == (uint)CERTAIN_NOTHING;
    const uints verdict =
        certain == (uint)CERTAIN_APART ? SAME_WORD(VERDICT_APART) : SAME_WORD(VERDICT_MEETS);
    if (!ANY(open)) return verdict;
    return open ? certain_verdict(a, b, open) : verdict;
}

// `undecided_by_filter` has capacity for every pair.
KERNEL void filter_pairs(GLOBAL const uint* found, uint first, uint pair_capacity, GLOBAL const uint* owners,
                         GLOBAL const real* poses, GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                         GLOBAL const uchar* boundary, GLOBAL const uint* open, GLOBAL uchar* verdicts,
                         GLOBAL uint* undecided_by_filter, GLOBAL uint* status) {
    const Candidates all = {found, owners, poses, tetrahedra, vertices, boundary};
    const ulong count =
        OVER_OPEN ? status[STATUS_WAITING + LIST_OPEN] : rows_in(status + STATUS_PAIRS, pair_capacity);
    const ulong step = (ulong)GLOBAL_COUNT * PACK;
    for (ulong i = (OVER_OPEN ? 0u : (ulong)first) + (ulong)GLOBAL_ID * PACK; i < count; i += step) {
        const uint present = elements_below(i, count);
        const uints index =
            OVER_OPEN ? first + PAIR_OF_OPEN(entries_of(open, i, present)) : numbers_from((uint)i, present);
        uints skipped = SAME_WORD(0);
        if (OVER_OPEN == 0) FOR_PACK(k) AT(skipped, k) = lacks_boundary(&all, (uint)AT(index, k));
        if (ALL(skipped != 0u)) continue;
        const uints verdict = filtered(&all, index);
        FOR_PACK(k) {
            if (k >= present || AT(skipped, k) != 0u) continue;
            verdicts[AT(index, k)] = (uchar)AT(verdict, k);
            if (AT(verdict, k) == VERDICT_OPEN)
                undecided_by_filter[counter_add(status + STATUS_UNDECIDED_BY_FILTER, 1u)] =
                    (uint)AT(index, k);
        }
    }
}
