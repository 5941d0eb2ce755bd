// SPDX-License-Identifier: MIT
// The certified filter in the cell's precision: a verdict for every pair, and a list of those it
// cannot decide.
#include "backends/portable.h"

#define CERTAIN_IN_DOUBLE 0
#include "algorithms/contacts/certainty.clh"

// `undecided_by_filter` has room for every pair.
KERNEL void filter_pairs(GLOBAL const uint* found, uint first, uint pair_capacity, GLOBAL const uint* bodies,
                         GLOBAL const real* poses, GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                         GLOBAL uchar* verdicts, GLOBAL uint* undecided_by_filter, GLOBAL uint* status) {
    const Candidates all = {found, bodies, poses, tetrahedra, vertices, 0};
    const ulong count = stored(status + STATUS_PAIRS, pair_capacity);
    for (ulong i = (ulong)first + GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        Point a[4];
        Point b[4];
        load_pair(&all, (uint)i, a, b);
        const int verdict = certain_verdict(a, b);
        verdicts[i] = (uchar)verdict;
        if (verdict == VERDICT_OPEN)
            undecided_by_filter[counter_add(status + STATUS_UNDECIDED_BY_FILTER, 1u)] = (uint)i;
    }
}
