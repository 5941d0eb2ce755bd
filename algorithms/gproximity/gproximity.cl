// SPDX-License-Identifier: MIT
// gProximity's traversal with dynamic load balancing (Lauterbach, Mo, Manocha 2010), from its published
// description and the numbers of its two implementations. Every work-group owns a queue of node pairs in
// global memory. It works on a local queue that it loads from the top of its own queue. A counter of idle
// groups ends the launch. Balancing then evens out the queues (balance.cl).
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/broad_phase/body_pairs.clh"
#include "algorithms/answer/emit.clh"
#include "algorithms/gproximity/queues.clh"
#include "algorithms/hierarchy/node.clh"

#ifndef LOCAL_QUEUE
#define LOCAL_QUEUE 600
#endif
#ifndef INITIAL_ITEMS
#define INITIAL_ITEMS 192
#endif
#ifndef IDLE_LIMIT
#define IDLE_LIMIT 86
#endif
#ifndef REFILL
#define REFILL 0
#endif
#ifndef FULL_EXIT
#define FULL_EXIT 1
#endif

// Arguments of a launch of walks.
typedef struct {
    GLOBAL const real* nodes;
    GLOBAL const uint* trees;
    GLOBAL const uint* pairs;
    PairOutput output;
} Job;

// Result of one node pair: a candidate pair, nothing, or two children to push.
typedef struct {
    uint pair, a, b;
    uint descend; // 0 none, 1 children of a, 2 children of b
} Step;

DEVICE Step walk_item(const Job* job, Step step, Tally* tally) {
    const uint body_a = body_a_of(job->pairs, step.pair);
    const uint body_b = body_b_of(job->pairs, step.pair);
    GLOBAL const uint* a = tree_of(job->trees, body_a);
    GLOBAL const uint* b = tree_of(job->trees, body_b);
    GLOBAL const real* node_a = node_at(job->nodes, a[TREE_NODES] + step.a);
    GLOBAL const real* node_b = node_at(job->nodes, b[TREE_NODES] + step.b);
    step.descend = 0u;
    if (WINDOWED
        && !in_window(job->output.status, first_item_below(step.a, a[TREE_ITEMS]),
                      (ulong)last_item_below(step.a, a[TREE_ITEMS]) + 1))
        return step;
    // The other order of the two nodes finds these pairs.
    if (SELF && body_a == body_b
        && first_item_below(step.a, a[TREE_ITEMS]) > last_item_below(step.b, b[TREE_ITEMS]))
        return step;
    if (COUNT_WORK) tally->tests += 1;
    if (!overlap(node_a, node_b)) return step;
    const int leaf_a = is_leaf(step.a, a[TREE_ITEMS]);
    const int leaf_b = is_leaf(step.b, b[TREE_ITEMS]);
    if (leaf_a && leaf_b && EMITS_SLOTS) {
        emit_slots(&job->output, first_slot_of(a) + leaf_item(step.a, a[TREE_ITEMS]),
                   first_slot_of(b) + leaf_item(step.b, b[TREE_ITEMS]));
    } else if (leaf_a && leaf_b) {
        const WordRow pair = {body_a, body_b, leaf_item(step.a, a[TREE_ITEMS]),
                              leaf_item(step.b, b[TREE_ITEMS])};
        emit(tally, &job->output, pair);
    } else {
        step.descend = leaf_b || (!leaf_a && node_size(node_a) > node_size(node_b)) ? 1u : 2u;
    }
    return step;
}

// Pushes the two children of a step into the local queue, or past its end onto the top of the group's own
// queue. The caller ensures that this queue has the capacity.
DEVICE void push_children(Step step, LOCAL uint* queue, LOCAL uint* size, GLOBAL uint* own, uint stored) {
    const uint slot = LOCAL_ATOMIC_ADD(size, 2u);
    for (uint child = 0; child < 2u; ++child) {
        const uint a = step.descend == 1u ? first_child(step.a) + child : step.a;
        const uint b = step.descend == 2u ? first_child(step.b) + child : step.b;
        if (slot + child < (uint)LOCAL_QUEUE) {
            queue[(slot + child) * ITEM_WORDS] = step.pair;
            queue[(slot + child) * ITEM_WORDS + 1u] = a;
            queue[(slot + child) * ITEM_WORDS + 2u] = b;
        } else {
            GLOBAL uint* item = own + (ulong)(stored + slot + child - (uint)LOCAL_QUEUE) * ITEM_WORDS;
            item[0] = step.pair;
            item[1] = a;
            item[2] = b;
        }
    }
}

// Words that a group shares.
#define SIZE 0   // items in the local queue
#define STORED 1 // items in the group's own queue in global memory, below the local ones
#define TAKE 2   // items of SIZE that are still on top of the own queue and must be loaded
#define STOP 3

// Takes up to INITIAL_ITEMS from the top of the own queue.
DEVICE void take_items(LOCAL uint* shared, uint stored) {
    const uint most = (uint)INITIAL_ITEMS < (uint)LOCAL_QUEUE ? (uint)INITIAL_ITEMS : (uint)LOCAL_QUEUE;
    shared[TAKE] = stored < most ? stored : most;
    shared[STORED] = stored - shared[TAKE];
    shared[SIZE] = shared[TAKE];
    shared[STOP] = shared[SIZE] == 0u ? 1u : 0u;
}

// Ends a round of `active` items: accounts for items past the local queue, refills an empty one, and decides
// whether the group stops. It stops without items or progress, with a full local or own queue, or when too
// many groups are idle.
DEVICE void settle_round(LOCAL uint* shared, uint active, uint queue_capacity, GLOBAL uint* idle,
                         GLOBAL uint* status) {
    const uint size = shared[SIZE];
    const uint spilled = size > (uint)LOCAL_QUEUE ? size - (uint)LOCAL_QUEUE : 0u;
    const uint margin = 2u * (uint)GROUP_SIZE + (uint)LOCAL_QUEUE;
    shared[TAKE] = 0u;
    shared[SIZE] = size - spilled;
    shared[STORED] += spilled;
    if (COUNT_WORK && spilled != 0u) counter_add(status + STATUS_SPILLS, spilled);
    if (REFILL && size == 0u && shared[STORED] != 0u) {
        take_items(shared, shared[STORED]);
        if (COUNT_WORK) counter_add(status + STATUS_REFILLS, 1u);
    }
    uint stop = shared[SIZE] == 0u || active == 0u ? 1u : 0u;
    if (FULL_EXIT && shared[SIZE] + (uint)GROUP_SIZE >= (uint)LOCAL_QUEUE) stop = 1u;
    if (FULL_EXIT && shared[STORED] + margin >= queue_capacity) stop = 1u;
    if (stop == 0u && ATOMIC_READ(idle) >= (uint)IDLE_LIMIT) stop = 1u;
    shared[STOP] = stop;
}

// One launch: every group empties its queue as far as the rules allow. A round processes the top of the local
// queue, at most one item per work-item. Even if all its items split, the group's own queue can store them.
KERNEL void traverse_queues(GLOBAL const real* nodes, GLOBAL const uint* trees, GLOBAL const uint* bodies,
                            GLOBAL const uint* ids, GLOBAL const uint* tetrahedra, GLOBAL const uint* pairs,
                            GLOBAL uint* items, GLOBAL uint* counts, uint queue_capacity, GLOBAL uint* idle,
                            GLOBAL uint* found, uint capacity, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, queue, LOCAL_QUEUE * ITEM_WORDS);
    LOCAL_ARRAY(uint, shared, 4);
    const Job job = {nodes, trees, pairs, {bodies, ids, tetrahedra, found, capacity, status}};
    GLOBAL uint* own = items + (ulong)GROUP_ID * queue_capacity * ITEM_WORDS;
    Tally tally = empty_tally();
    // Set in work-item 0 if the group starts without items; it then counts as idle from the start.
    uint idles = 0;
    if (LOCAL_ID == 0u) {
        uint stored = counts[GROUP_ID];
        if (stored > queue_capacity) { // what is past the end was never written
            ATOMIC_ADD(status + STATUS_EXCEEDED + EXCEEDED_QUEUE, 1u);
            stored = queue_capacity;
        }
        take_items(shared, stored);
        idles = shared[STOP];
        if (idles != 0u) ATOMIC_ADD(idle, 1u);
    }
    BARRIER;
    uint stop;
    do { // runs at least once, as loops with barriers must; a group without items stops at its end
        const uint size = shared[SIZE];
        const uint stored = shared[STORED];
        for (uint i = LOCAL_ID; i < shared[TAKE] * ITEM_WORDS; i += (uint)GROUP_SIZE)
            queue[i] = own[(ulong)stored * ITEM_WORDS + i];
        BARRIER;
        const uint free_items = queue_capacity - stored - size;
        const uint lanes = size < (uint)GROUP_SIZE ? size : (uint)GROUP_SIZE;
        const uint active = lanes < free_items ? lanes : free_items;
        Step step = {0u, 0u, 0u, 0u};
        if (LOCAL_ID < active) {
            LOCAL const uint* item = queue + (size - active + LOCAL_ID) * ITEM_WORDS;
            step.pair = item[0];
            step.a = item[1];
            step.b = item[2];
        }
        if (LOCAL_ID == 0u) shared[SIZE] = size - active;
        BARRIER;
        if (LOCAL_ID < active) {
            step = walk_item(&job, step, &tally);
            if (step.descend != 0u) push_children(step, queue, shared + SIZE, own, stored);
        }
        BARRIER_GLOBAL;
        if (LOCAL_ID == 0u) settle_round(shared, active, queue_capacity, idle, status);
        BARRIER;
        stop = shared[STOP];
    } while (stop == 0u);
    // Stores the items back onto the own queue's top. Items of a refill that is not loaded yet are still
    // there.
    for (uint i = LOCAL_ID; shared[TAKE] == 0u && i < shared[SIZE] * ITEM_WORDS; i += (uint)GROUP_SIZE)
        own[(ulong)shared[STORED] * ITEM_WORDS + i] = queue[i];
    if (LOCAL_ID == 0u) {
        counts[GROUP_ID] = shared[STORED] + shared[SIZE];
        if (idles == 0u) ATOMIC_ADD(idle, 1u);
    }
    flush(&tally, status);
}
