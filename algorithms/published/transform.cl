// SPDX-License-Identifier: MIT
// World vertices as in the paper's code: a separate stage, whose result the host reads back and uploads
// again.
// Host variants: PRECISION
#include "backends/portable.h"
#include "algorithms/bodies/body.clh"

KERNEL void transform_vertices(GLOBAL const real* vertices, GLOBAL real* world,
                               GLOBAL const uint* vertex_bodies, GLOBAL const real* poses,
                               uint vertex_count) {
    for (ulong i = GLOBAL_ID; i < vertex_count; i += GLOBAL_COUNT) {
        const Pose pose = pose_at(poses, vertex_bodies[i]);
        const Point q = transformed(&pose, ((GLOBAL const RealRow*)vertices)[i]);
        RealRow row;
        row.x = q.x;
        row.y = q.y;
        row.z = q.z;
        row.w = 0;
        ((GLOBAL RealRow*)world)[i] = row;
    }
}
