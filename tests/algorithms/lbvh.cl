// SPDX-License-Identifier: MIT
// One binary tree per body with stored children, and the simplest traversal: every tetrahedron of body a
// queries body b's tree.
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/answer/emit.clh"
#include "algorithms/bodies/leaf.clh"
#include "algorithms/bounds/volume.clh"
#include "algorithms/broad_phase/body_pairs.clh"

// A tree over n items has n - 1 inner nodes, in depth order from the root (node 0), followed by the leaves in
// item order. A node is K reals. Each inner node has a row of children (two node numbers) that belongs to the
// mesh and serves all its bodies. Each body has one tree row of TREE_WORDS words.
#define TREE_WORDS 4
#define TREE_NODES 0    // slot of its root
#define TREE_CHILDREN 1 // first row of children of its mesh
// start of its mesh in `depths`: the first inner node of each depth, then their number
#define TREE_DEPTHS 2
#define TREE_DEPTH_COUNT 3

#define STATUS_LEAF_HITS STATUS_OWN

// Halving 2^31 items, the most whose nodes a word can number, ends after 31 steps. The stack contains one
// sibling for each depth above the current node, and the node itself.
#define STACK_CAPACITY 32

DEVICE GLOBAL const uint* tree_of(GLOBAL const uint* trees, uint body) {
    return trees + (ulong)body * TREE_WORDS;
}

DEVICE uint items_of(GLOBAL const uint* bodies, uint body) {
    return bodies[(ulong)body * BODY_WORDS + BODY_TETRAHEDRON_COUNT];
}

DEVICE GLOBAL const uint* children_of(GLOBAL const uint* children, GLOBAL const uint* tree, uint node) {
    return children + ((ulong)tree[TREE_CHILDREN] + node) * 2;
}

// Empty slabs (lower end above upper end) overlap nothing and enlarge no union. Negative zero becomes
// positive, so equal slabs have equal bits.
DEVICE void bound_tetrahedron(const Solids* solids, const BodyTetrahedron* one, int is_active,
                              GLOBAL real* node) {
    real slabs[K];
    for (int axis = 0; axis < DIRECTIONS; ++axis) {
        slabs[axis] = REAL_INFINITY;
        slabs[axis + DIRECTIONS] = -REAL_INFINITY;
    }
    if (is_active) widen_by_tetrahedron(solids, one, slabs);
    for (int word = 0; word < K; ++word) node[word] = slabs[word] + (real)0;
}

// Merges the inner nodes first..end - 1, all of one depth, from their children.
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

// Bottom-up refit; one work-group per body of `chosen`. `skipped` has a word per node slot: nonzero in a leaf
// whose tetrahedron the frame skips.
KERNEL void refit_trees(GLOBAL real* nodes, GLOBAL real* volumes, GLOBAL const uint* trees,
                        GLOBAL const uint* children, GLOBAL const uint* depths, GLOBAL const uint* skipped,
                        GLOBAL const uint* chosen, GLOBAL const uint* bodies, GLOBAL const real* poses,
                        GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                        GLOBAL const real* next_poses, GLOBAL const real* next_vertices, float margin) {
    const Solids solids = {tetrahedra, poses, vertices, next_poses, next_vertices, margin};
    const uint body = chosen[GROUP_ID];
    GLOBAL const uint* tree = tree_of(trees, body);
    GLOBAL real* own = nodes + (ulong)tree[TREE_NODES] * K;
    const uint items = items_of(bodies, body);
    for (uint item = LOCAL_ID; item < items; item += GROUP_SIZE) {
        const uint leaf = items - 1u + item;
        const BodyTetrahedron one = tetrahedron_of(((GLOBAL const WordRow*)bodies)[body], body, item);
        bound_tetrahedron(&solids, &one, skipped[tree[TREE_NODES] + leaf] == 0u, own + (ulong)leaf * K);
    }
    BARRIER_GLOBAL;
    GLOBAL const uint* first = depths + tree[TREE_DEPTHS];
    uint depth = tree[TREE_DEPTH_COUNT];
    do { // at least once: PoCL 3.1 miscompiles barriers in a loop that may not run
        if (depth > 0u) {
            --depth;
            merge_depth(own, children, tree, first[depth], first[depth + 1u]);
        }
        BARRIER_GLOBAL;
    } while (depth > 0u);
    for (uint word = LOCAL_ID; word < (uint)K; word += GROUP_SIZE)
        volumes[(ulong)body * K + word] = own[word];
}

// Arguments of a launch.
typedef struct {
    GLOBAL const real* nodes;
    GLOBAL const uint* trees;
    GLOBAL const uint* children;
    PairOutput output;
} Job;

// Emits every leaf of body b that overlaps the leaf of a's item. Returns the number of leaves.
DEVICE uint query_leaf(const Job* job, uint a, uint b, uint item, Tally* tally) {
    const uint leaf = items_of(job->output.bodies, a) - 1u + item;
    GLOBAL const real* query = job->nodes + ((ulong)tree_of(job->trees, a)[TREE_NODES] + leaf) * K;
    GLOBAL const uint* tree = tree_of(job->trees, b);
    GLOBAL const real* nodes = job->nodes + (ulong)tree[TREE_NODES] * K;
    const uint inner = items_of(job->output.bodies, b) - 1u;
    uint stack[STACK_CAPACITY];
    uint stack_size = 1;
    uint hits = 0;
    stack[0] = 0u;
    if (COUNT_WORK) tally->seeds += 1;
    while (stack_size > 0u) {
        const uint node = stack[--stack_size];
        if (COUNT_WORK) tally->tests += 1;
        if (!overlap(query, nodes + (ulong)node * K)) continue;
        if (node < inner) {
            GLOBAL const uint* child = children_of(job->children, tree, node);
            stack[stack_size++] = child[0];
            stack[stack_size++] = child[1];
        } else {
            ++hits;
            const WordRow found = {a, b, item, node - inner};
            emit(tally, &job->output, found);
        }
    }
    return hits;
}

// A work-group processes body pairs and a block of GROUP_SIZE items of their bodies a. `blocks` is enough for
// any body, so the launch needs no scan to count queries.
KERNEL void query_leaves(GLOBAL const real* nodes, GLOBAL const uint* trees, GLOBAL const uint* children,
                         GLOBAL const uint* bodies, GLOBAL const uint* ids, GLOBAL const uint* tetrahedra,
                         GLOBAL const uint* pairs, uint pair_capacity, uint blocks, GLOBAL uint* found,
                         uint capacity, GLOBAL uint* status) {
    const Job job = {nodes, trees, children, {bodies, ids, tetrahedra, found, capacity, status}};
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
