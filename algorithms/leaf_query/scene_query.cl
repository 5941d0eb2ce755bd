// SPDX-License-Identifier: MIT
// Leaf queries of one tree over all bodies (scene_tree.clh): each leaf finds the leaves behind it that its
// bounds overlap, so that each pair is found once. A query starts at the rope of its own leaf and follows
// ropes and left children, without a stack. It leaves out nodes whose leaves are all of its own body.
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/answer/emit.clh"
#include "algorithms/broad_phase/filters.clh"
#include "algorithms/hierarchy/scene_tree.clh"

// Tables of the tree, and which bodies meet: those that the scene's filters allow, or with `has_lists` those
// of lists. `partners`: for each body, and at their end, where its list starts; the lists, ascending.
typedef struct {
    GLOBAL const real* leaf_bounds;
    GLOBAL const WordRow* leaves;
    GLOBAL const WordRow* inner;
    GLOBAL const real* inner_bounds;
    GLOBAL const uint* filters;
    GLOBAL const uint* partners;
    uint has_lists;
} SceneTables;

// A leaf that queries.
typedef struct {
    uint owner, item;
    uint first, end;  // its body's list
    int meets_itself; // its body may be in pairs with itself
    uint accepted;    // the last body that it may meet, or its own
} LeafQuery;

DEVICE int is_in_list(GLOBAL const uint* partners, uint first, uint end, uint body) {
    uint low = first;
    uint high = end;
    while (low < high) {
        const uint middle = low + (high - low) / 2u;
        if (partners[middle] < body)
            low = middle + 1u;
        else
            high = middle;
    }
    return low < end && partners[low] == body;
}

DEVICE LeafQuery query_of(const SceneTables* scene, WordRow leaf) {
    LeafQuery query;
    query.owner = leaf.z;
    query.item = item_of(leaf.w);
    query.accepted = body_of(leaf.z);
    query.first = query.end = 0;
    query.meets_itself = SELF && (leaf.w & MEETS_ITSELF) != 0u;
    if (scene->has_lists != 0u) {
        query.first = scene->partners[query.accepted];
        query.end = scene->partners[query.accepted + 1u];
        query.meets_itself = SELF && is_in_list(scene->partners, query.first, query.end, query.accepted);
    }
    return query;
}

// Whether no leaf below a node with this owner is in a pair with the query. Reads no bounds.
DEVICE int is_left_out(const SceneTables* scene, const LeafQuery* query, uint owner) {
    if (owner == query->owner) return !query->meets_itself;
    return scene->has_lists == 0u && (owner & query->owner & PASSIVE) != 0u;
}

// Whether the query may meet the body of a node with this owner. Neighbouring nodes are often of one body.
DEVICE int may_meet_owner(const SceneTables* scene, LeafQuery* query, uint owner) {
    const uint body = body_of(owner);
    if ((!FILTERED && scene->has_lists == 0u) || body == MANY_BODIES || body == query->accepted) return 1;
    const int may = scene->has_lists != 0u ? is_in_list(scene->partners, query->first, query->end, body)
                                           : may_meet(scene->filters, body_of(query->owner), body);
    if (may) query->accepted = body;
    return may;
}

// A pair has the smaller body first, and of one body the smaller item.
DEVICE void emit_found(GLOBAL const uint* trees, const LeafQuery* query, WordRow leaf,
                       const PairOutput* output, Tally* tally) {
    const uint own = body_of(query->owner);
    const uint other = body_of(leaf.z);
    const uint item = item_of(leaf.w);
    const int is_first = own < other || (own == other && query->item < item);
    const WordRow row = {is_first ? own : other, is_first ? other : own, is_first ? query->item : item,
                         is_first ? item : query->item};
    if (EMITS_SLOTS)
        emit_slots(output, first_slot_of(tree_of(trees, row.x)) + row.z,
                   first_slot_of(tree_of(trees, row.y)) + row.w);
    else
        emit(tally, output, row);
}

// Queries the nodes behind leaf number `leaf`.
DEVICE void query_behind(const SceneTables* scene, GLOBAL const uint* trees, uint leaf,
                         const PairOutput* output, Tally* tally) {
    const WordRow own_row = scene->leaves[leaf];
    LeafQuery query = query_of(scene, own_row);
    if (scene->has_lists != 0u && query.first == query.end) return;
    Node own, other;
    load_node(scene->leaf_bounds, leaf, &own);
    if (COUNT_WORK) tally->seeds += 1;
    uint node = own_row.y;
    while (node != NO_NODE) {
        const int is_inner = (node & SCENE_LEAF) == 0u;
        const uint number = node & ~SCENE_LEAF;
        const WordRow row = is_inner ? scene->inner[number] : scene->leaves[number];
        node = row.y;
        if (is_left_out(scene, &query, row.z)) continue;
        if (COUNT_WORK) tally->tests += 1;
        load_node(is_inner ? scene->inner_bounds : scene->leaf_bounds, number, &other);
        if (!nodes_overlap(&own, &other) || !may_meet_owner(scene, &query, row.z)) continue;
        if (is_inner)
            node = row.x;
        else
            emit_found(trees, &query, row, output, tally);
    }
}

KERNEL void query_scene(GLOBAL const real* leaf_bounds, GLOBAL const uint* leaves, GLOBAL const uint* inner,
                        GLOBAL const real* inner_bounds, uint count, GLOBAL const uint* filters,
                        GLOBAL const uint* partners, uint has_lists, GLOBAL const uint* state,
                        GLOBAL const uint* trees, GLOBAL const uint* bodies, GLOBAL const uint* ids,
                        GLOBAL const uint* tetrahedra, GLOBAL uint* found, uint capacity,
                        GLOBAL uint* status) {
    const SceneTables scene = {leaf_bounds,
                               (GLOBAL const WordRow*)leaves,
                               (GLOBAL const WordRow*)inner,
                               inner_bounds,
                               filters,
                               partners,
                               has_lists};
    const PairOutput output = {bodies, ids, tetrahedra, found, capacity, status};
    Tally tally = empty_tally();
    if (GLOBAL_ID == 0u) status[STATUS_REBUILDS] = state[STATE_BUILDS];
    for (uint leaf = GLOBAL_ID; leaf < count; leaf += GLOBAL_COUNT)
        query_behind(&scene, trees, leaf, &output, &tally);
    flush(&tally, status);
}
