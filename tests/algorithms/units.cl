// SPDX-License-Identifier: MIT
// unit.clh on its own.
// Host variants: PRECISION
#include "backends/portable.h"

#include "algorithms/narrow_phase/unit.clh"

DEVICE Point point_of(RealRow row) {
    Point p;
    p.x = row.x;
    p.y = row.y;
    p.z = row.z;
    return p;
}

DEVICE RealRow row_of(Point p) {
    RealRow row;
    row.x = p.x;
    row.y = p.y;
    row.z = p.z;
    row.w = 0;
    return row;
}

// Four rows for each pair of vectors: the two, which make_units() replaces, and room for unit() of each.
KERNEL void unite_vectors(GLOBAL real* vectors, uint pairs) {
    LOCAL_ARRAY(Point, first, GROUP_SIZE);
    LOCAL_ARRAY(Point, second, GROUP_SIZE);
    for (uint i = GLOBAL_ID; i < pairs; i += GLOBAL_COUNT) {
        GLOBAL RealRow* row = (GLOBAL RealRow*)vectors + 4 * (ulong)i;
        first[LOCAL_ID] = point_of(row[0]);
        second[LOCAL_ID] = point_of(row[1]);
        row[2] = row_of(unit(first[LOCAL_ID]));
        row[3] = row_of(unit(second[LOCAL_ID]));
        make_units(first + LOCAL_ID, second + LOCAL_ID);
        row[0] = row_of(first[LOCAL_ID]);
        row[1] = row_of(second[LOCAL_ID]);
    }
}
