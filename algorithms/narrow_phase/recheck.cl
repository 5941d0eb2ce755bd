// SPDX-License-Identifier: MIT
// The certified decision in double, for all pairs or for those that the filter cannot decide, and the
// transfer of the remaining pairs to the host and back.
// Host variants: PRECISION
#include "backends/portable.h"

#define CERTAIN_IN_DOUBLE 1
#include "algorithms/narrow_phase/certainty.clh"

#ifndef RECHECK_ALL
#define RECHECK_ALL 0
#endif
#define CORNER_REALS 24 // per pair: A's corners, then B's

// `undecided_by_filter`: the list that filter_pairs made. `undecided_by_double`: pairs that double cannot
// decide either; it has capacity for every pair.
KERNEL void recheck_pairs(GLOBAL const uint* found, uint first, uint pair_capacity, GLOBAL const uint* owners,
                          GLOBAL const real* poses, GLOBAL const uint* tetrahedra,
                          GLOBAL const real* vertices, GLOBAL const uchar* boundary, GLOBAL uchar* verdicts,
                          GLOBAL const uint* undecided_by_filter, GLOBAL uint* undecided_by_double,
                          GLOBAL uint* status) {
    const Candidates all = {found, owners, poses, tetrahedra, vertices, boundary};
    const uint pairs = rows_in(status + STATUS_PAIRS, pair_capacity);
    const ulong count = RECHECK_ALL ? pairs : status[STATUS_UNDECIDED_BY_FILTER];
    for (ulong i = (RECHECK_ALL ? (ulong)first : 0u) + GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        const uint index = RECHECK_ALL ? (uint)i : undecided_by_filter[i];
        if (index < first) continue;
        if (RECHECK_ALL != 0 && lacks_boundary(&all, index)) continue;
        Point a[4];
        Point b[4];
        load_pair(&all, index, a, b, 0);
        const uint verdict = certain_verdict(a, b, ALWAYS);
        verdicts[index] = (uchar)verdict;
        if (verdict == VERDICT_OPEN)
            undecided_by_double[counter_add(status + STATUS_UNDECIDED_BY_DOUBLE, 1u)] = index;
    }
}

// World corners of the list's pairs from `first` on, for the host to decide.
KERNEL void gather_corners(GLOBAL const uint* found, GLOBAL const uint* owners, GLOBAL const real* poses,
                           GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                           GLOBAL const uint* undecided_by_double, uint first, uint count,
                           GLOBAL real* corners) {
    const Candidates all = {found, owners, poses, tetrahedra, vertices, 0};
    for (uint i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        Point corner[8];
        load_pair(&all, undecided_by_double[(ulong)first + i], corner, corner + 4, 0);
        for (int j = 0; j < 8; ++j) {
            GLOBAL real* to = corners + (ulong)i * CORNER_REALS + 3 * j;
            to[0] = corner[j].x;
            to[1] = corner[j].y;
            to[2] = corner[j].z;
        }
    }
}

// Stores the host's verdicts of those pairs.
KERNEL void settle_pairs(GLOBAL const uint* undecided_by_double, uint first, uint count,
                         GLOBAL const uchar* settled, GLOBAL uchar* verdicts) {
    for (uint i = GLOBAL_ID; i < count; i += GLOBAL_COUNT)
        verdicts[undecided_by_double[(ulong)first + i]] = settled[i];
}
