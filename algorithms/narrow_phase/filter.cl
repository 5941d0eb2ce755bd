// SPDX-License-Identifier: MIT
// The certified filter in the cell's precision: a verdict for every pair that has the boundary faces that the
// contact rule needs, and a list of those it cannot decide. Each pair first gets a certificate, from this
// kernel or, with OVER_OPEN, from certify_pairs before it.
// Host variants: PRECISION
#include "backends/portable.h"

#define CERTAIN_IN_DOUBLE 0
#include "algorithms/narrow_phase/certainty.clh"
#include "algorithms/narrow_phase/certificate.clh"
#include "algorithms/narrow_phase/open_pairs.clh"

// 1: only the pairs in the list `open`, whose words are relative to `first`.
#ifndef OVER_OPEN
#define OVER_OPEN 0
#endif

DEVICE int filtered(const Candidates* all, uint index) {
    Point a[4];
    Point b[4];
    load_pair(all, index, a, b);
    if (!OVER_OPEN) {
        const int certain = certificate_of(a, b);
        if (certain != CERTAIN_NOTHING) return certain == CERTAIN_APART ? VERDICT_APART : VERDICT_MEETS;
    }
    return certain_verdict(a, b);
}

// `undecided_by_filter` has capacity for every pair.
KERNEL void filter_pairs(GLOBAL const uint* found, uint first, uint pair_capacity, GLOBAL const uint* owners,
                         GLOBAL const real* poses, GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                         GLOBAL const uchar* boundary, GLOBAL const uint* open, GLOBAL uchar* verdicts,
                         GLOBAL uint* undecided_by_filter, GLOBAL uint* status) {
    const Candidates all = {found, owners, poses, tetrahedra, vertices, boundary};
    const ulong count =
        OVER_OPEN ? status[STATUS_WAITING + LIST_OPEN] : stored(status + STATUS_PAIRS, pair_capacity);
    for (ulong i = (OVER_OPEN ? 0u : (ulong)first) + GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        const uint index = OVER_OPEN ? first + PAIR_OF_OPEN(open[i]) : (uint)i;
        if (OVER_OPEN == 0 && lacks_boundary(&all, index)) continue;
        const int verdict = filtered(&all, index);
        verdicts[index] = (uchar)verdict;
        if (verdict == VERDICT_OPEN)
            undecided_by_filter[counter_add(status + STATUS_UNDECIDED_BY_FILTER, 1u)] = index;
    }
}
