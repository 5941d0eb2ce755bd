// SPDX-License-Identifier: MIT
// Transform and refit, fused and level-synchronous. A launch walks strips: subtrees of at most STRIP levels
// of nodes below a given root, bottom up, one work-group for STRIP_JOBS strips. Leaves read vertices through
// the pose, so that rigid bodies keep no transformed vertices; inner nodes are the exact min/max of their
// children.
#include "backends/portable.h"
#include "algorithms/kdop/body.clh"

#ifndef STRIP
#define STRIP 5
#endif

#define STRIP_JOBS ((GROUP_SIZE >> STRIP) > 0 ? (GROUP_SIZE >> STRIP) : 1)
#define JOB_WORDS 3 // body, chunk, heap index of the strip's root

// Negative zero becomes positive: equal slabs then have equal bits.
DEVICE void store(GLOBAL real* node, const real* lower, const real* upper) {
    for (int axis = 0; axis < SLABS; ++axis) {
        node[axis] = lower[axis] + (real)0;
        node[axis + SLABS] = upper[axis] + (real)0;
    }
}

DEVICE void merge(GLOBAL real* node, GLOBAL const real* a, GLOBAL const real* b) {
    for (int axis = 0; axis < SLABS; ++axis) {
        node[axis] = a[axis] < b[axis] ? a[axis] : b[axis];
        node[axis + SLABS] = a[axis + SLABS] > b[axis + SLABS] ? a[axis + SLABS] : b[axis + SLABS];
    }
}

DEVICE void bound_tetrahedron(GLOBAL real* node, GLOBAL const uint* body, GLOBAL const real* pose,
                              GLOBAL const uint* tetrahedra, GLOBAL const real* vertices, uint item) {
    real lower[SLABS];
    real upper[SLABS];
    for (int axis = 0; axis < SLABS; ++axis) {
        lower[axis] = REAL_INFINITY;
        upper[axis] = -REAL_INFINITY;
    }
    for (uint corner = 0; corner < 4u; ++corner) {
        const Point p = corner_at(body, pose, tetrahedra, vertices, item, corner);
        widen_by_point(p.x, p.y, p.z, lower, upper);
    }
    store(node, lower, upper);
}

DEVICE void copy_node(GLOBAL real* node, GLOBAL const real* from) {
    for (int i = 0; i < K; ++i) node[i] = from[i];
}

DEVICE void refit_node(GLOBAL real* nodes, GLOBAL const uint* body, GLOBAL const uint* levels,
                       GLOBAL const real* pose, GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                       uint level, uint chunk, uint node) {
    GLOBAL const uint* row = levels + (ulong)(body[BODY_LEVELS] + level) * LEVEL_WORDS;
    const Chunk c = chunk_at(body[BODY_NODES], row, chunk);
    if (node >= 2u * c.items) return;
    GLOBAL real* target = nodes + (ulong)(c.base + node) * K;
    if (!is_leaf(node, c.items)) {
        merge(target, node_at(nodes, c.base + 2u * node), node_at(nodes, c.base + 2u * node + 1u));
        return;
    }
    const uint item = chunk * CHUNK_ITEMS + leaf_item(node, c.items);
    if (level == 0u) {
        bound_tetrahedron(target, body, pose, tetrahedra, vertices, item);
        return;
    }
    copy_node(target, node_at(nodes, chunk_at(body[BODY_NODES], row - LEVEL_WORDS, item).base + 1u));
}

KERNEL void refit_strips(GLOBAL real* nodes, GLOBAL const uint* bodies, GLOBAL const uint* levels,
                         GLOBAL const real* poses, GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                         GLOBAL const uint* jobs, uint first_job, uint job_count, uint level, uint height) {
    for (uint up = 0; up <= height; ++up) {
        const uint depth = height - up;
        for (uint i = LOCAL_ID; i < ((uint)STRIP_JOBS << depth); i += GROUP_SIZE) {
            const uint job = GROUP_ID * STRIP_JOBS + (i >> depth);
            if (job < job_count) {
                GLOBAL const uint* row = jobs + (ulong)(first_job + job) * JOB_WORDS;
                const uint node = (row[2] << depth) + (i & ((1u << depth) - 1u));
                refit_node(nodes, bodies + (ulong)row[0] * BODY_WORDS, levels, poses + (ulong)row[0] * 12,
                           tetrahedra, vertices, level, row[1], node);
            }
        }
        BARRIER_GLOBAL;
    }
}

// The volume of the whole body, in its slot 0: the union of its top level's chunk roots (paper, Algorithm 1).
KERNEL void refit_roots(GLOBAL real* nodes, GLOBAL const uint* bodies, GLOBAL const uint* levels,
                        uint body_count) {
    const uint index = GLOBAL_ID;
    if (index >= body_count * SLABS) return;
    GLOBAL const uint* body = bodies + (ulong)(index / SLABS) * BODY_WORDS;
    const uint axis = index % SLABS;
    GLOBAL const uint* level =
        levels + (ulong)(body[BODY_LEVELS] + body[BODY_LEVEL_COUNT] - 1u) * LEVEL_WORDS;
    real lower = REAL_INFINITY;
    real upper = -REAL_INFINITY;
    for (uint chunk = 0; chunk < level[LEVEL_CHUNKS]; ++chunk) {
        GLOBAL const real* root = node_at(nodes, chunk_at(body[BODY_NODES], level, chunk).base + 1u);
        lower = root[axis] < lower ? root[axis] : lower;
        upper = root[axis + SLABS] > upper ? root[axis + SLABS] : upper;
    }
    nodes[(ulong)body[BODY_NODES] * K + axis] = lower;
    nodes[(ulong)body[BODY_NODES] * K + axis + SLABS] = upper;
}

// World vertices as the paper's code makes them: a stage of its own, read back and uploaded again by the
// host.
KERNEL void transform_vertices(GLOBAL const real* vertices, GLOBAL real* world,
                               GLOBAL const uint* vertex_bodies, GLOBAL const real* poses,
                               uint vertex_count) {
    for (uint i = GLOBAL_ID; i < vertex_count; i += GLOBAL_COUNT) {
        Point p;
        p.x = vertices[(ulong)i * 4];
        p.y = vertices[(ulong)i * 4 + 1];
        p.z = vertices[(ulong)i * 4 + 2];
        const Point q = transformed(poses + (ulong)vertex_bodies[i] * 12, p);
        world[(ulong)i * 4] = q.x;
        world[(ulong)i * 4 + 1] = q.y;
        world[(ulong)i * 4 + 2] = q.z;
        world[(ulong)i * 4 + 3] = 0;
    }
}
