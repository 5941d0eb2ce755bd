// SPDX-License-Identifier: MIT
// One binary tree a body with stored children, and the plainest walk of it: a query of body b's tree for
// every tetrahedron of body a.
#include "backends/portable.h"
#include "algorithms/answer/emit.clh"
#include "algorithms/bodies/body.clh"
#include "algorithms/bounds/volume.clh"
#include "algorithms/broad_phase/body_pairs.clh"

// A tree over n items has n - 1 inner nodes, depth after depth from the root, which is 0, and behind them the
// leaves in the order of their items. A node is K reals. The rows of an inner node's children, two node
// numbers each, belong to a mesh and serve all its bodies. One row a body, in TREE_WORDS words.
#define TREE_WORDS 4
#define TREE_NODES 0    // the slot of its root
#define TREE_CHILDREN 1 // its mesh's first row of children
#define TREE_DEPTHS 2   // its mesh's place in depths: the first inner node of each depth, and their number
#define TREE_DEPTH_COUNT 3

#define STATUS_LEAF_HITS STATUS_OWN

// Halving the most items whose nodes a word can number, 2^31, ends after 31 steps; at each depth above the
// node at hand its sibling waits.
#define MOST_WAITING 32

DEVICE GLOBAL const uint* tree_of(GLOBAL const uint* trees, uint body) {
    return trees + (ulong)body * TREE_WORDS;
}

DEVICE uint items_of(GLOBAL const uint* bodies, uint body) {
    return bodies[(ulong)body * BODY_WORDS + BODY_TETRAHEDRON_COUNT];
}

DEVICE GLOBAL const uint* children_of(GLOBAL const uint* children, GLOBAL const uint* tree, uint node) {
    return children + ((ulong)tree[TREE_CHILDREN] + node) * 2;
}

// Slabs that end before they start overlap nothing and widen nothing. Negative zero becomes positive: equal
// slabs then have equal bits.
DEVICE void bound_tetrahedron(GLOBAL const uint* bodies, GLOBAL const real* poses,
                              GLOBAL const uint* tetrahedra, GLOBAL const real* vertices, uint body,
                              uint item, int takes_part, GLOBAL real* node) {
    real slabs[K];
    for (int axis = 0; axis < DIRECTIONS; ++axis) {
        slabs[axis] = REAL_INFINITY;
        slabs[axis + DIRECTIONS] = -REAL_INFINITY;
    }
    if (takes_part) {
        Point corner[4];
        load_corners(bodies, poses, tetrahedra, vertices, body, item, corner);
        const Point drift = drift_at(poses, body);
        for (int i = 0; i < 4; ++i) widen_by_point(corner[i], drift, slabs, slabs + DIRECTIONS);
    }
    for (int word = 0; word < K; ++word) node[word] = slabs[word] + (real)0;
}

// The inner nodes of one depth, which are first..end - 1, from those below.
DEVICE void merge_depth(GLOBAL real* nodes, GLOBAL const uint* children, GLOBAL const uint* tree, uint first,
                        uint end) {
    for (uint node = first + LOCAL_ID; node < end; node += GROUP_SIZE) {
        GLOBAL const uint* child = children_of(children, tree, node);
        GLOBAL const real* a = nodes + (ulong)child[0] * K;
        GLOBAL const real* b = nodes + (ulong)child[1] * K;
        for (int word = 0; word < K; ++word)
            nodes[(ulong)node * K + word] =
                word < DIRECTIONS ? MINIMUM(a[word], b[word]) : MAXIMUM(a[word], b[word]);
    }
}

// Bottom up, a work-group a body of those `chosen`. `skipped`: a word a node slot, of which those of leaves
// say whether the frame skips their tetrahedra.
KERNEL void refit_trees(GLOBAL real* nodes, GLOBAL real* volumes, GLOBAL const uint* trees,
                        GLOBAL const uint* children, GLOBAL const uint* depths, GLOBAL const uint* skipped,
                        GLOBAL const uint* chosen, GLOBAL const uint* bodies, GLOBAL const real* poses,
                        GLOBAL const uint* tetrahedra, GLOBAL const real* vertices) {
    const uint body = chosen[GROUP_ID];
    GLOBAL const uint* tree = tree_of(trees, body);
    GLOBAL real* own = nodes + (ulong)tree[TREE_NODES] * K;
    const uint items = items_of(bodies, body);
    for (uint item = LOCAL_ID; item < items; item += GROUP_SIZE) {
        const uint leaf = items - 1u + item;
        bound_tetrahedron(bodies, poses, tetrahedra, vertices, body, item,
                          skipped[tree[TREE_NODES] + leaf] == 0u, own + (ulong)leaf * K);
    }
    BARRIER_GLOBAL;
    GLOBAL const uint* first = depths + tree[TREE_DEPTHS];
    uint depth = tree[TREE_DEPTH_COUNT];
    do { // once at least: PoCL 3.1 gets barriers wrong in a loop that might not run at all
        if (depth > 0u) {
            --depth;
            merge_depth(own, children, tree, first[depth], first[depth + 1u]);
        }
        BARRIER_GLOBAL;
    } while (depth > 0u);
    for (uint word = LOCAL_ID; word < (uint)K; word += GROUP_SIZE)
        volumes[(ulong)body * K + word] = own[word];
}

// What a launch works on.
typedef struct {
    GLOBAL const real* nodes;
    GLOBAL const uint* trees;
    GLOBAL const uint* children;
    GLOBAL const uint* bodies;
    GLOBAL const uint* ids;
    GLOBAL uint* found;
    uint capacity;
    GLOBAL uint* status;
} Job;

// Everything in body b that the leaf of a's item overlaps. Returns how many leaves that is.
DEVICE uint query_leaf(const Job* job, uint a, uint b, uint item, Tally* tally) {
    const uint leaf = items_of(job->bodies, a) - 1u + item;
    GLOBAL const real* query = job->nodes + ((ulong)tree_of(job->trees, a)[TREE_NODES] + leaf) * K;
    GLOBAL const uint* tree = tree_of(job->trees, b);
    GLOBAL const real* nodes = job->nodes + (ulong)tree[TREE_NODES] * K;
    const uint inner = items_of(job->bodies, b) - 1u;
    uint stack[MOST_WAITING];
    uint waiting = 1;
    uint hits = 0;
    stack[0] = 0u;
    if (COUNT_WORK) tally->seeds += 1;
    while (waiting > 0u) {
        const uint node = stack[--waiting];
        if (COUNT_WORK) tally->tests += 1;
        if (!overlap(query, nodes + (ulong)node * K)) continue;
        if (node < inner) {
            GLOBAL const uint* child = children_of(job->children, tree, node);
            stack[waiting++] = child[0];
            stack[waiting++] = child[1];
        } else {
            ++hits;
            emit(tally, job->status, job->found, job->capacity, job->bodies, job->ids, a, b, item,
                 node - inner);
        }
    }
    return hits;
}

// A work-group takes body pairs and a block of GROUP_SIZE items of their bodies a, `blocks` of which are
// enough for any body: how many queries there are needs no scan.
KERNEL void query_leaves(GLOBAL const real* nodes, GLOBAL const uint* trees, GLOBAL const uint* children,
                         GLOBAL const uint* bodies, GLOBAL const uint* ids, GLOBAL const uint* pairs,
                         uint pair_capacity, uint blocks, GLOBAL uint* found, uint capacity,
                         GLOBAL uint* status) {
    const Job job = {nodes, trees, children, bodies, ids, found, capacity, status};
    const ulong work = (ulong)body_pair_count(pair_capacity, status) * blocks;
    Tally tally = empty_tally();
    ulong hits = 0;
    for (ulong i = GROUP_ID; i < work; i += GROUP_COUNT) {
        const uint pair = (uint)(i / blocks);
        const uint item = (uint)(i % blocks) * (uint)GROUP_SIZE + LOCAL_ID;
        const uint a = body_a_of(pairs, pair);
        if (item < items_of(bodies, a) && in_window(status, item, (ulong)item + 1))
            hits += query_leaf(&job, a, body_b_of(pairs, pair), item, &tally);
    }
    flush(&tally, status);
    if (COUNT_WORK) counter_add_wide(status + STATUS_LEAF_HITS, hits);
}
