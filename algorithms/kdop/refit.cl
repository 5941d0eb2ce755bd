// SPDX-License-Identifier: MIT
// Transform and refit, fused and level-synchronous. A launch takes strips: subtrees of at most `height` + 1
// depths below a given root. A work-group makes the nodes of its strips bottom up in local memory and writes
// them out once, neighbouring work-items to neighbouring words, so that device memory sees each node once and
// in whole sectors. Leaves read vertices through the pose, so that rigid bodies keep no transformed vertices;
// inner nodes are the exact min/max of their children.
#include "backends/portable.h"
#include "algorithms/kdop/body.clh"

// Nodes a work-group has room for: a power of two, at least those of one strip.
#ifndef TILE_NODES
#define TILE_NODES 128
#endif

#define NODE_STRIDE (K + 1) // odd: work-items that write a node each hit different banks
// Strips lie one word further apart than their nodes take, so that they do not hit the same banks either.
#define HEAP(tile, strip, height) ((tile) + (strip) * (((2u << (height)) * NODE_STRIDE) + 1u))
#define JOB_WORDS 3 // body, chunk, heap index of the strip's root

// A strip's row in local memory: slot of heap index 0, items of the chunk (0: no strip), root, job.
#define STRIP_WORDS 4
#define STRIP_BASE 0
#define STRIP_ITEMS 1
#define STRIP_ROOT 2
#define STRIP_JOB 3

// What a launch knows.
typedef struct {
    GLOBAL real* nodes;
    GLOBAL const uint* bodies;
    GLOBAL const uint* levels;
    GLOBAL const real* poses;
    GLOBAL const uint* tetrahedra;
    GLOBAL const real* vertices;
    GLOBAL const uint* jobs;
    uint level, height;
} Refit;

DEVICE GLOBAL const uint* level_row(const Refit* refit, uint body, uint level) {
    return refit->levels + (ulong)(refit->bodies[body * BODY_WORDS + BODY_LEVELS] + level) * LEVEL_WORDS;
}

DEVICE void load_strip(const Refit* refit, uint job, uint job_count, LOCAL uint* strip) {
    strip[STRIP_ITEMS] = 0u;
    strip[STRIP_ROOT] = 1u;
    if (job >= job_count) return;
    GLOBAL const uint* row = refit->jobs + (ulong)job * JOB_WORDS;
    const Chunk chunk = chunk_at(refit->bodies[row[0] * BODY_WORDS + BODY_NODES],
                                 level_row(refit, row[0], refit->level), row[1]);
    strip[STRIP_BASE] = chunk.base;
    strip[STRIP_ITEMS] = chunk.items;
    strip[STRIP_ROOT] = row[2];
    strip[STRIP_JOB] = job;
}

// Negative zero becomes positive: equal slabs then have equal bits.
DEVICE void bound_tetrahedron(const Refit* refit, uint body, uint item, real* node) {
    Point corner[4];
    load_corners(refit->bodies, refit->poses, refit->tetrahedra, refit->vertices, body, item, corner);
    for (int axis = 0; axis < SLABS; ++axis) {
        node[axis] = REAL_INFINITY;
        node[axis + SLABS] = -REAL_INFINITY;
    }
    for (int i = 0; i < 4; ++i) widen_by_point(corner[i].x, corner[i].y, corner[i].z, node, node + SLABS);
    for (int word = 0; word < K; ++word) node[word] = node[word] + (real)0;
}

// The node over two.
#define MERGE(node, a, b)                                                                                    \
    for (int axis = 0; axis < SLABS; ++axis) {                                                               \
        (node)[axis] = MINIMUM((a)[axis], (b)[axis]);                                                        \
        (node)[axis + SLABS] = MAXIMUM((a)[axis + SLABS], (b)[axis + SLABS]);                                \
    }

// A leaf of level 0 is over a tetrahedron, one of a higher level is the root of a chunk below.
DEVICE void make_leaf(const Refit* refit, LOCAL const uint* strip, uint node, real* values) {
    GLOBAL const uint* job = refit->jobs + (ulong)strip[STRIP_JOB] * JOB_WORDS;
    const uint item = job[1] * CHUNK_ITEMS + leaf_item(node, strip[STRIP_ITEMS]);
    if (refit->level == 0u) {
        bound_tetrahedron(refit, job[0], item, values);
        return;
    }
    const Chunk below = chunk_at(refit->bodies[job[0] * BODY_WORDS + BODY_NODES],
                                 level_row(refit, job[0], refit->level - 1u), item);
    GLOBAL const real* from = node_at(refit->nodes, below.base + 1u);
    for (int word = 0; word < K; ++word) values[word] = from[word];
}

// A node of the deepest depth: a leaf, or one over nodes of an earlier launch.
DEVICE void make_deepest(const Refit* refit, LOCAL const uint* strip, uint node, real* values) {
    if (is_leaf(node, strip[STRIP_ITEMS])) {
        make_leaf(refit, strip, node, values);
        return;
    }
    GLOBAL const real* child = node_at(refit->nodes, strip[STRIP_BASE] + 2u * node);
    MERGE(values, child, child + K)
}

// Small nodes are made in pairs; of larger ones a work-item makes one, as the tile of two would leave room
// for too few work-groups.
#define IN_PAIRS (K <= 8)

// The two lowest depths: a work-item makes two siblings and merges them before they leave its registers.
DEVICE void make_pairs(const Refit* refit, LOCAL const uint* strips, uint strip_count, LOCAL real* tile) {
    const uint depth = refit->height - 1u;
    for (uint i = LOCAL_ID; i < strip_count << depth; i += GROUP_SIZE) {
        LOCAL const uint* strip = strips + (i >> depth) * STRIP_WORDS;
        LOCAL real* heap = HEAP(tile, i >> depth, refit->height);
        const uint in_depth = i & ((1u << depth) - 1u);
        const uint node = (strip[STRIP_ROOT] << depth) + in_depth;
        const uint place = (1u << depth) + in_depth;
        if (node >= 2u * strip[STRIP_ITEMS]) continue;
        const uint inner = is_leaf(node, strip[STRIP_ITEMS]) ? 0u : 1u;
        real both[K];
        for (int axis = 0; axis < SLABS; ++axis) {
            both[axis] = REAL_INFINITY;
            both[axis + SLABS] = -REAL_INFINITY;
        }
        NO_UNROLL for (uint child = 0; child <= inner; ++child) {
            real values[K];
            make_deepest(refit, strip, (node << inner) + child, values);
            for (int word = 0; word < K; ++word)
                heap[((place << inner) + child) * NODE_STRIDE + word] = values[word];
            MERGE(both, both, values)
        }
        for (int word = 0; word < K; ++word) heap[place * NODE_STRIDE + word] = both[word];
    }
}

// A depth above those, or the only one.
DEVICE void make_depth(const Refit* refit, LOCAL const uint* strips, uint strip_count, uint depth,
                       LOCAL real* tile) {
    for (uint i = LOCAL_ID; i < strip_count << depth; i += GROUP_SIZE) {
        LOCAL const uint* strip = strips + (i >> depth) * STRIP_WORDS;
        LOCAL real* heap = HEAP(tile, i >> depth, refit->height);
        const uint in_depth = i & ((1u << depth) - 1u);
        const uint node = (strip[STRIP_ROOT] << depth) + in_depth;
        const uint place = (1u << depth) + in_depth;
        if (node >= 2u * strip[STRIP_ITEMS]) continue;
        if (depth == refit->height || is_leaf(node, strip[STRIP_ITEMS])) {
            real values[K];
            make_deepest(refit, strip, node, values);
            for (int word = 0; word < K; ++word) heap[place * NODE_STRIDE + word] = values[word];
        } else {
            MERGE(heap + place * NODE_STRIDE, heap + 2u * place * NODE_STRIDE,
                  heap + (2u * place + 1u) * NODE_STRIDE)
        }
    }
}

// `count` nodes that lie one after the other here and there. A work-item's words are a whole number of nodes
// apart, so that padding is skipped without a division.
#define RUN_ITEMS (GROUP_SIZE / K * K)

DEVICE void write_run(LOCAL const real* from, GLOBAL real* to, uint count) {
#if GROUP_SIZE < K
    for (uint i = LOCAL_ID; i < count * K; i += GROUP_SIZE) to[i] = from[i + i / K];
#else
    if (LOCAL_ID >= (uint)RUN_ITEMS) return;
    LOCAL const real* word = from + LOCAL_ID + LOCAL_ID / K;
    for (uint i = LOCAL_ID; i < count * K; i += RUN_ITEMS) {
        to[i] = *word;
        word += RUN_ITEMS + RUN_ITEMS / K; // NODE_STRIDE is one more than K
    }
#endif
}

// All of a chunk is one run of nodes; a part of it is a run for each depth.
DEVICE void write_strip(const Refit* refit, LOCAL const uint* strip, LOCAL const real* heap) {
    const uint end = 2u * strip[STRIP_ITEMS];
    const uint root = strip[STRIP_ROOT];
    for (uint depth = 0; depth <= refit->height; ++depth) {
        const uint first = root << depth;
        if (first >= end) return;
        const uint most = root == 1u ? (2u << refit->height) - 1u : 1u << depth;
        write_run(heap + (1u << depth) * NODE_STRIDE, refit->nodes + (ulong)(strip[STRIP_BASE] + first) * K,
                  end - first < most ? end - first : most);
        if (root == 1u) return;
    }
}

// `first_job`, `job_count`: the strips of this launch; a work-group takes TILE_NODES / 2^(height + 1) of
// them.
KERNEL void refit_strips(GLOBAL real* nodes, GLOBAL const uint* bodies, GLOBAL const uint* levels,
                         GLOBAL const real* poses, GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                         GLOBAL const uint* jobs, uint first_job, uint job_count, uint level, uint height) {
    LOCAL_ARRAY(real, tile, TILE_NODES * NODE_STRIDE + TILE_NODES / 2);
    LOCAL_ARRAY(uint, strips, TILE_NODES / 2 * STRIP_WORDS);
    const Refit refit = {
        nodes, bodies, levels, poses, tetrahedra, vertices, jobs + (ulong)first_job * JOB_WORDS,
        level, height};
    const uint strip_count = (uint)TILE_NODES >> (height + 1u);
    for (uint i = LOCAL_ID; i < strip_count; i += GROUP_SIZE)
        load_strip(&refit, GROUP_ID * strip_count + i, job_count, strips + i * STRIP_WORDS);
    BARRIER;
    // One loop for all depths: PoCL 3.1 gets barriers wrong in a loop that might not run at all.
    for (uint up = 0; up <= height; ++up) {
        if (!IN_PAIRS)
            make_depth(&refit, strips, strip_count, height - up, tile);
        else if (up == 1u)
            make_pairs(&refit, strips, strip_count, tile);
        else if (up > 1u || height == 0u)
            make_depth(&refit, strips, strip_count, height - up, tile);
        BARRIER;
    }
    for (uint i = 0; i < strip_count; ++i)
        write_strip(&refit, strips + i * STRIP_WORDS, HEAP(tile, i, height));
}

// The leaves of a level above 0, a word a work-item.
DEVICE void copy_roots(GLOBAL real* nodes, uint first, GLOBAL const uint* level) {
    for (uint i = LOCAL_ID; i < level[LEVEL_ITEMS] * K; i += GROUP_SIZE) {
        const uint item = i / K;
        const Chunk chunk = chunk_at(first, level, item / CHUNK_ITEMS);
        const Chunk below = chunk_at(first, level - LEVEL_WORDS, item);
        const uint leaf = leaf_node(item % CHUNK_ITEMS, chunk.items);
        nodes[(ulong)(chunk.base + leaf) * K + i % K] = nodes[(ulong)(below.base + 1u) * K + i % K];
    }
}

// The inner nodes of one depth of all chunks of a level.
DEVICE void merge_depth(GLOBAL real* nodes, uint first, GLOBAL const uint* level, uint depth) {
    for (uint i = LOCAL_ID; i < (level[LEVEL_CHUNKS] << depth) * K; i += GROUP_SIZE) {
        const uint index = i / K;
        const uint word = i % K;
        const Chunk chunk = chunk_at(first, level, index >> depth);
        const uint node = (1u << depth) + (index & ((1u << depth) - 1u));
        if (is_leaf(node, chunk.items)) continue;
        GLOBAL const real* child = nodes + (ulong)(chunk.base + 2u * node) * K + word;
        const real a = child[0];
        const real b = child[K];
        nodes[(ulong)(chunk.base + node) * K + word] = word < SLABS ? MINIMUM(a, b) : MAXIMUM(a, b);
    }
}

// The levels from `first_level` on, which are small, and the volume of the whole body in its slot 0: the
// union of its top level's chunk roots (paper, Algorithm 1). A work-group a body.
KERNEL void refit_tops(GLOBAL real* nodes, GLOBAL const uint* bodies, GLOBAL const uint* levels,
                       GLOBAL const uint* chosen, uint first_level) {
    GLOBAL const uint* body = bodies + (ulong)chosen[GROUP_ID] * BODY_WORDS;
    const uint first = body[BODY_NODES];
    const uint level_count = body[BODY_LEVEL_COUNT];
    GLOBAL const uint* rows = levels + (ulong)body[BODY_LEVELS] * LEVEL_WORDS;
    uint level = first_level;
    do { // once at least, and every barrier in it: see refit_strips
        GLOBAL const uint* row = rows + (ulong)level * LEVEL_WORDS;
        const int exists = level < level_count;
        if (exists) copy_roots(nodes, first, row);
        BARRIER_GLOBAL;
        for (uint depth = LEAF_BITS; depth-- > 0u;) {
            if (exists) merge_depth(nodes, first, row, depth);
            BARRIER_GLOBAL;
        }
        ++level;
    } while (level < level_count);
    GLOBAL const uint* top = rows + (ulong)(level_count - 1u) * LEVEL_WORDS;
    for (uint word = LOCAL_ID; word < (uint)K; word += GROUP_SIZE) {
        real all = word < SLABS ? REAL_INFINITY : -REAL_INFINITY;
        for (uint chunk = 0; chunk < top[LEVEL_CHUNKS]; ++chunk) {
            const real own = node_at(nodes, chunk_at(first, top, chunk).base + 1u)[word];
            all = word < SLABS ? MINIMUM(own, all) : MAXIMUM(own, all);
        }
        nodes[(ulong)first * K + word] = all;
    }
}

// World vertices as the paper's code makes them: a stage of its own, read back and uploaded again by the
// host.
KERNEL void transform_vertices(GLOBAL const real* vertices, GLOBAL real* world,
                               GLOBAL const uint* vertex_bodies, GLOBAL const real* poses,
                               uint vertex_count) {
    for (uint i = GLOBAL_ID; i < vertex_count; i += GLOBAL_COUNT) {
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
