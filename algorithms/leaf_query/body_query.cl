// SPDX-License-Identifier: MIT
// Leaf queries: each tetrahedron of the body with fewer ones queries the other body's tree, which is one
// complete binary tree (heap.clh). All queries of all body pairs are one launch.
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/answer/emit.clh"
#include "algorithms/broad_phase/body_pairs.clh"
#include "algorithms/hierarchy/node.clh"

// The two bodies of a pair. `a_queries`: tetrahedra of a query the tree of b, otherwise those of b the tree
// of a.
typedef struct {
    GLOBAL const uint* querying; // tree rows
    GLOBAL const uint* queried;
    uint body_a, body_b;
    int a_queries;
} BodyQuery;

DEVICE BodyQuery body_query(GLOBAL const uint* trees, GLOBAL const uint* pairs, uint pair) {
    BodyQuery query;
    query.body_a = body_a_of(pairs, pair);
    query.body_b = body_b_of(pairs, pair);
    GLOBAL const uint* a = tree_of(trees, query.body_a);
    GLOBAL const uint* b = tree_of(trees, query.body_b);
    query.a_queries = a[TREE_ITEMS] <= b[TREE_ITEMS];
    query.querying = query.a_queries ? a : b;
    query.queried = query.a_queries ? b : a;
    return query;
}

DEVICE void emit_answer(const BodyQuery* query, const PairOutput* output, uint item, uint found,
                        Tally* tally) {
    const uint item_a = query->a_queries ? item : found;
    const uint item_b = query->a_queries ? found : item;
    if (EMITS_SLOTS) {
        const uint own = first_slot_of(query->querying) + item;
        const uint other = first_slot_of(query->queried) + found;
        emit_slots(output, query->a_queries ? own : other, query->a_queries ? other : own);
    } else {
        const WordRow row = {query->body_a, query->body_b, item_a, item_b};
        emit(tally, output, row);
    }
}

// Queries the tree of the other body for the leaves that overlap `item`. A node's children follow each other
// in memory and are tested together. `open` has a bit per depth of the current node, bit 0 for its own: its
// sibling is still to be visited. The walk needs neither a stack nor links.
DEVICE void query_tree(const BodyQuery* query, GLOBAL const real* nodes, const PairOutput* output, uint item,
                       Tally* tally) {
    const uint items = query->queried[TREE_ITEMS];
    const uint base = query->queried[TREE_NODES];
    uint node = ROOT_NODE;
    uint open = 0;
    Node own, other;
    load_node(nodes, query->querying[TREE_NODES] + leaf_node(item, query->querying[TREE_ITEMS]), &own);
    load_node(nodes, base + ROOT_NODE, &other);
    if (COUNT_WORK) tally->seeds += 1;
    if (COUNT_WORK) tally->tests += 1;
    if (!nodes_overlap(&own, &other)) return;
    if (is_leaf(ROOT_NODE, items)) {
        emit_answer(query, output, item, 0u, tally);
        return;
    }
    for (;;) {
        const uint child = first_child(node);
        uint left = 0; // bit i: child i is to be visited
        UNROLL for (uint i = 0; i < 2u; ++i) {
            // Items up to this one query for the others.
            if (SELF && query->body_a == query->body_b && last_item_below(child + i, items) <= item) continue;
            if (COUNT_WORK) tally->tests += 1;
            load_node(nodes, base + child + i, &other);
            if (!nodes_overlap(&own, &other)) continue;
            if (is_leaf(child + i, items))
                emit_answer(query, output, item, leaf_item(child + i, items), tally);
            else
                left |= 1u << i;
        }
        if (left != 0u) {
            node = child + (left >> 1 & ~left & 1u);
            open = open << 1 | (left == 3u ? 1u : 0u);
        } else {
            if (open == 0u) return;
            const uint up = COUNT_ONES((open & (0u - open)) - 1u);
            node = (node >> up) + 1u;
            open = (open >> up) - 1u;
        }
    }
}

// A turn of a work-group: up to GROUP_SIZE queries of a body pair, which has `blocks` turns.
KERNEL void query_leaves(GLOBAL const real* nodes, GLOBAL const uint* trees, GLOBAL const uint* bodies,
                         GLOBAL const uint* ids, GLOBAL const uint* tetrahedra, GLOBAL const uint* pairs,
                         uint pair_capacity, uint blocks, GLOBAL uint* found, uint capacity,
                         GLOBAL uint* status) {
    const PairOutput output = {bodies, ids, tetrahedra, found, capacity, status};
    const ulong turns = (ulong)body_pair_count(pair_capacity, status) * blocks;
    Tally tally = empty_tally();
    for (ulong turn = GROUP_ID; turn < turns; turn += GROUP_COUNT) {
        const uint item = (uint)(turn % blocks) * (uint)GROUP_SIZE + LOCAL_ID;
        const BodyQuery query = body_query(trees, pairs, (uint)(turn / blocks));
        if (LOCAL_ID == 0u && turn % blocks == 0u
            && query.querying[TREE_ITEMS] > (ulong)blocks * (uint)GROUP_SIZE)
            ATOMIC_ADD(status + STATUS_EXCEEDED + EXCEEDED_QUERIES, 1u);
        const int has_item = item < query.querying[TREE_ITEMS] && query.queried[TREE_ITEMS] != 0u
                             && (!query.a_queries || in_window(status, item, (ulong)item + 1));
        if (has_item) query_tree(&query, nodes, &output, item, &tally);
    }
    flush(&tally, status);
}
