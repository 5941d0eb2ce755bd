// SPDX-License-Identifier: MIT
// Overlap of the leaf k-DOPs of an explicit list of tetrahedron pairs, in rows as in pairs.clh. Constructed
// cases reach the overlap tests of the walks, on refitted nodes, without a walk.
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/hierarchy/node.clh"
#include "algorithms/answer/emit.clh"

// Bits of an answer.
#define LEAVES_OVERLAP 1u        // by nodes_overlap, from registers
#define LEAVES_OVERLAP_STORED 2u // by overlap, from device memory
#define PARENTS_OVERLAP 4u       // all ancestors at equal distances from the leaves, up to the chunk roots
#define VOLUMES_OVERLAP 8u       // the k-DOPs of the two bodies

DEVICE Chunk chunk_of(GLOBAL const uint* tree, GLOBAL const uint* levels, uint item) {
    return chunk_at(tree[TREE_NODES], level_of(levels, tree, 0u), item / CHUNK_ITEMS);
}

DEVICE uint leaves_overlap(GLOBAL const real* nodes, uint slot_a, uint slot_b) {
    Node a;
    Node b;
    load_node(nodes, slot_a, &a);
    load_node(nodes, slot_b, &b);
    return nodes_overlap(&a, &b) ? LEAVES_OVERLAP : 0u;
}

DEVICE uint parents_overlap(GLOBAL const real* nodes, Chunk a, uint node_a, Chunk b, uint node_b) {
    while (node_a != ROOT_NODE || node_b != ROOT_NODE) {
        if (node_a != ROOT_NODE) node_a = parent_of(node_a);
        if (node_b != ROOT_NODE) node_b = parent_of(node_b);
        if (!overlap(node_at(nodes, a.base + node_a), node_at(nodes, b.base + node_b))) return 0u;
    }
    return PARENTS_OVERLAP;
}

// answers[i]: the bits above for pair i.
KERNEL void test_pair_list(GLOBAL const real* nodes, GLOBAL const real* volumes, GLOBAL const uint* trees,
                           GLOBAL const uint* levels, GLOBAL const uint* pairs, uint pair_count,
                           GLOBAL uint* answers) {
    for (ulong i = GLOBAL_ID; i < pair_count; i += GLOBAL_COUNT) {
        GLOBAL const uint* pair = pairs + i * PAIR_WORDS;
        const Chunk a = chunk_of(tree_of(trees, pair[0]), levels, pair[2]);
        const Chunk b = chunk_of(tree_of(trees, pair[1]), levels, pair[3]);
        const uint node_a = leaf_node(pair[2] % CHUNK_ITEMS, a.items);
        const uint node_b = leaf_node(pair[3] % CHUNK_ITEMS, b.items);
        GLOBAL const real* volume_a = volume_of(volumes, pair[0]);
        GLOBAL const real* volume_b = volume_of(volumes, pair[1]);
        answers[i] = leaves_overlap(nodes, a.base + node_a, b.base + node_b)
                     | (overlap(node_at(nodes, a.base + node_a), node_at(nodes, b.base + node_b))
                            ? LEAVES_OVERLAP_STORED
                            : 0u)
                     | parents_overlap(nodes, a, node_a, b, node_b)
                     | (overlap(volume_a, volume_b) ? VOLUMES_OVERLAP : 0u);
    }
}
