// SPDX-License-Identifier: MIT
// Bounds and owners of the inner nodes of a tree over a scene (scene_tree.clh), in every frame. Both are
// those of a range of leaves, which a few boxes and leaves cover exactly. Minima and maxima do not depend on
// the choice. So each work-item makes whole nodes, and no level of the tree waits for another.
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/hierarchy/scene_tree.clh"

// What leaves have in common: their bounds, and the least and the greatest number of a body.
typedef struct {
    real slab[K];
    uint least, most, is_active;
} Cover;

// Tables of the tree. `bounds`: of leaves. Boxes have K reals, and an owner row: least and greatest body, and
// whether one is active.
typedef struct {
    GLOBAL const real* bounds;
    GLOBAL const WordRow* leaves;
    GLOBAL const real* boxes;
    GLOBAL const WordRow* owners;
    uint count; // of leaves
} Scene;

DEVICE Cover empty_cover(void) {
    Cover cover;
    UNROLL for (int axis = 0; axis < DIRECTIONS; ++axis) {
        cover.slab[axis] = REAL_INFINITY;
        cover.slab[axis + DIRECTIONS] = -REAL_INFINITY;
    }
    cover.least = MANY_BODIES;
    cover.most = 0;
    cover.is_active = 0;
    return cover;
}

// A level of runs: leaves, or boxes from number `base` on.
typedef struct {
    int is_leaves;
    uint base, count;
} RunLevel;

DEVICE RunLevel leaf_level(uint count) {
    const RunLevel level = {1, 0u, count};
    return level;
}

DEVICE RunLevel level_above(RunLevel below) {
    const RunLevel level = {0, below.is_leaves ? 0u : below.base + below.count, boxes_over(below.count)};
    return level;
}

DEVICE void widen_cover(Cover* cover, GLOBAL const real* from, uint least, uint most, uint is_active) {
    Node node;
    load_node(from, 0u, &node);
    UNROLL for (int axis = 0; axis < DIRECTIONS; ++axis) {
        cover->slab[axis] = MINIMUM(node.slab[axis], cover->slab[axis]);
        cover->slab[axis + DIRECTIONS] =
            MAXIMUM(node.slab[axis + DIRECTIONS], cover->slab[axis + DIRECTIONS]);
    }
    cover->least = least < cover->least ? least : cover->least;
    cover->most = most > cover->most ? most : cover->most;
    cover->is_active |= is_active;
}

// Widens a cover by run `i` of a level.
DEVICE void widen_by_run(const Scene* scene, RunLevel level, uint i, Cover* cover) {
    if (level.is_leaves) {
        const WordRow leaf = scene->leaves[i];
        const uint body = body_of(leaf.z);
        widen_cover(cover, node_at(scene->bounds, i), body, body, (leaf.z & PASSIVE) == 0u ? 1u : 0u);
    } else {
        const WordRow owner = scene->owners[level.base + i];
        widen_cover(cover, node_at(scene->boxes, level.base + i), owner.x, owner.y, owner.z);
    }
}

// The cover of leaves first..end - 1. At each level it takes the runs that no whole box of the level above
// covers.
DEVICE Cover cover_of(const Scene* scene, uint first, uint end) {
    Cover cover = empty_cover();
    RunLevel level = leaf_level(scene->count);
    for (;;) {
        const int is_top = level.count <= BOX_ITEMS;
        while (first < end && (is_top || first % BOX_ITEMS != 0u))
            widen_by_run(scene, level, first++, &cover);
        while (first < end && end % BOX_ITEMS != 0u) widen_by_run(scene, level, --end, &cover);
        if (first >= end) return cover;
        first /= BOX_ITEMS;
        end /= BOX_ITEMS;
        level = level_above(level);
    }
}

DEVICE void store_slabs(const Cover* cover, GLOBAL real* node) {
    UNROLL for (int word = 0; word < K; ++word) node[word] = cover->slab[word];
}

// Copies bounds of leaves from the trees of bodies, so that neighbours along the curve are so in memory. One
// word per work-item.
KERNEL void copy_leaf_bounds(GLOBAL const real* nodes, GLOBAL const uint* leaves, uint count,
                             GLOBAL real* bounds) {
    for (ulong i = GLOBAL_ID; i < (ulong)count * K; i += GLOBAL_COUNT) {
        const uint leaf = (uint)(i / K);
        bounds[i] = node_at(nodes, ((GLOBAL const WordRow*)leaves)[leaf].x)[i % K];
    }
}

// Makes the boxes of level `first_level`, and with `levels` = 2 also those of the level above it, which need
// no launch of their own: each is made from the same runs, those of level `first_level` - 1.
KERNEL void bound_boxes(GLOBAL const real* bounds, GLOBAL const uint* leaves, uint count, uint first_level,
                        uint levels, GLOBAL real* boxes, GLOBAL uint* owners) {
    const Scene scene = {bounds, (GLOBAL const WordRow*)leaves, boxes, (GLOBAL const WordRow*)owners, count};
    RunLevel below = leaf_level(count);
    for (uint level = 1; level < first_level; ++level) below = level_above(below);
    const RunLevel low = level_above(below);
    const RunLevel high = level_above(low);
    const uint all = low.count + (levels > 1u ? high.count : 0u);
    for (uint i = GLOBAL_ID; i < all; i += GLOBAL_COUNT) {
        const uint runs = i < low.count ? BOX_ITEMS : BOX_ITEMS * BOX_ITEMS;
        const uint box = i < low.count ? i : i - low.count;
        Cover cover = empty_cover();
        for (uint run = box * runs; run < (box + 1u) * runs && run < below.count; ++run)
            widen_by_run(&scene, below, run, &cover);
        const uint at = low.base + i; // the levels follow each other
        const WordRow owner = {cover.least, cover.most, cover.is_active, 0u};
        store_slabs(&cover, boxes + (ulong)at * K);
        ((GLOBAL WordRow*)owners)[at] = owner;
    }
}

// Makes bounds and owners of all inner nodes.
KERNEL void bound_inner_nodes(GLOBAL const real* bounds, GLOBAL const uint* leaves, uint count,
                              GLOBAL const real* boxes, GLOBAL const uint* owners, GLOBAL uint* inner,
                              GLOBAL real* inner_bounds) {
    const Scene scene = {bounds, (GLOBAL const WordRow*)leaves, boxes, (GLOBAL const WordRow*)owners, count};
    for (uint i = GLOBAL_ID; i + 1u < count; i += GLOBAL_COUNT) {
        const uint other = ((GLOBAL const WordRow*)inner)[i].w;
        const uint last = i < other ? other : i;
        const Cover cover = cover_of(&scene, i < other ? i : other, last + 1u);
        const uint body = cover.least == cover.most ? cover.least : MANY_BODIES;
        store_slabs(&cover, inner_bounds + (ulong)i * K);
        ((GLOBAL WordRow*)inner)[i].z = body | (cover.is_active != 0u ? 0u : PASSIVE);
    }
}
