// SPDX-License-Identifier: MIT
// Kernels between launches of walks: they fill the queues with roots and even them out. They know nothing of
// bounds, and their groups have a size of their own, so that a file of their own compiles for few settings.
// Host variants: PRECISION
#include "backends/portable.h"
#include "algorithms/broad_phase/body_pairs.clh"
#include "algorithms/gproximity/queues.clh"
#include "algorithms/orders/heap.clh"

DEVICE void copy_item(GLOBAL uint* to, GLOBAL const uint* from) {
    to[0] = from[0];
    to[1] = from[1];
    to[2] = from[2];
}

// Queue of item number `item` when `total` items are spread evenly over `queues`; the first queues get one
// more. *slot receives its index in that queue.
DEVICE uint queue_of_item(uint item, uint total, uint queues, uint* slot) {
    const uint per_queue = total / queues;
    const uint longer = total % queues; // queues with per_queue + 1 items
    const uint in_longer = longer * (per_queue + 1u);
    if (item < in_longer) {
        *slot = item % (per_queue + 1u);
        return item / (per_queue + 1u);
    }
    *slot = (item - in_longer) % per_queue;
    return longer + (item - in_longer) / per_queue;
}

DEVICE uint share_of_queue(uint queue, uint total, uint queues) {
    return total / queues + (queue < total % queues ? 1u : 0u);
}

// Spreads the root pairs of at most `most` body pairs, from number `first` on, evenly over the queues.
KERNEL void scatter_roots(GLOBAL uint* items, GLOBAL uint* counts, uint queues, uint queue_capacity,
                          uint first, uint most, GLOBAL const uint* status) {
    const uint all = body_pair_count(0xffffffffu, status);
    const uint rest = all > first ? all - first : 0u;
    const uint count = rest < most ? rest : most;
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) { // 32 bits might wrap around
        uint slot;
        const uint queue = queue_of_item((uint)i, count, queues, &slot);
        GLOBAL uint* item = items + ((ulong)queue * queue_capacity + slot) * ITEM_WORDS;
        item[0] = first + (uint)i;
        item[1] = ROOT_NODE;
        item[2] = ROOT_NODE;
    }
    for (ulong queue = GLOBAL_ID; queue < queues; queue += GLOBAL_COUNT)
        counts[queue] = share_of_queue((uint)queue, count, queues);
}

DEVICE uint add_items(uint sum, uint more) {
    return more < MOST_QUEUE_ITEMS - sum ? sum + more : MOST_QUEUE_ITEMS;
}

// Sums the queues and decides whether to balance: totals = {items, balance}, starts = exclusive sums. Sums
// saturate at MOST_QUEUE_ITEMS; then nothing is moved. One group.
KERNEL void plan_balance(GLOBAL const uint* counts, uint queues, uint low, uint high, GLOBAL uint* starts,
                         GLOBAL uint* totals) {
    LOCAL_ARRAY(uint, sums, GROUP_SIZE);
    LOCAL_ARRAY(uint, all_unbalanced, GROUP_SIZE);
    const uint part = (queues + (uint)GROUP_SIZE - 1u) / (uint)GROUP_SIZE;
    const uint first = LOCAL_ID * part < queues ? LOCAL_ID * part : queues;
    const uint last = first + part < queues ? first + part : queues;
    uint sum = 0;
    uint unbalanced = 0;
    for (uint i = first; i < last; ++i) {
        sum = add_items(sum, counts[i]);
        unbalanced |= counts[i] < low || counts[i] >= high ? 1u : 0u;
    }
    sums[LOCAL_ID] = sum;
    all_unbalanced[LOCAL_ID] = unbalanced;
    BARRIER;
    if (LOCAL_ID == 0u) {
        uint start = 0;
        uint any = 0;
        for (uint i = 0; i < (uint)GROUP_SIZE; ++i) {
            const uint own = sums[i];
            sums[i] = start;
            start = add_items(start, own);
            any |= all_unbalanced[i];
        }
        starts[queues] = start;
        totals[0] = start;
        totals[1] = start != 0u && start < MOST_QUEUE_ITEMS ? any : 0u;
    }
    BARRIER;
    uint start = sums[LOCAL_ID];
    for (uint i = first; i < last; ++i) {
        starts[i] = start;
        start = add_items(start, counts[i]);
    }
}

// Moves every item to its new queue with the whole device: the two-phase balance of g-Planner.
KERNEL void move_balance(GLOBAL const uint* from, GLOBAL uint* to, GLOBAL uint* counts, uint queues,
                         uint queue_capacity, GLOBAL const uint* starts, GLOBAL const uint* totals) {
    const uint total = totals[1] != 0u ? totals[0] : 0u;
    for (uint i = GLOBAL_ID; i < total; i += GLOBAL_COUNT) {
        uint low = 0;
        uint high = queues;
        while (low + 1u < high) {
            const uint middle = low + (high - low) / 2u;
            if (starts[middle] <= i)
                low = middle;
            else
                high = middle;
        }
        uint slot;
        const uint queue = queue_of_item(i, total, queues, &slot);
        copy_item(to + ((ulong)queue * queue_capacity + slot) * ITEM_WORDS,
                  from + ((ulong)low * queue_capacity + (i - starts[low])) * ITEM_WORDS);
    }
    for (uint queue = GLOBAL_ID; total != 0u && queue < queues; queue += GLOBAL_COUNT)
        counts[queue] = share_of_queue(queue, total, queues);
}

// The same as in the originals: one group fills output queue after output queue, in runs of at most one item
// per work-item with a barrier after each. It advances through source and target queues together.
KERNEL void move_balance_serially(GLOBAL const uint* from, GLOBAL uint* to, GLOBAL uint* counts, uint queues,
                                  uint queue_capacity, GLOBAL const uint* starts, GLOBAL const uint* totals) {
    const uint total = totals[1] != 0u ? totals[0] : 0u;
    uint source = 0;
    uint moved = 0;
    uint queue = 0;
    uint slot = 0;
    do { // runs at least once, as loops with barriers must; without items it moves nothing
        while (moved < total && starts[source + 1u] <= moved) ++source;
        while (moved < total && slot >= share_of_queue(queue, total, queues)) {
            ++queue;
            slot = 0;
        }
        uint run = moved < total ? starts[source + 1u] - moved : 0u;
        const uint space = share_of_queue(queue, total, queues) - slot;
        run = run < space ? run : space;
        run = run < (uint)GROUP_SIZE ? run : (uint)GROUP_SIZE;
        if (LOCAL_ID < run)
            copy_item(
                to + ((ulong)queue * queue_capacity + slot + LOCAL_ID) * ITEM_WORDS,
                from + ((ulong)source * queue_capacity + (moved - starts[source]) + LOCAL_ID) * ITEM_WORDS);
        BARRIER;
        moved += run;
        slot += run;
    } while (moved < total);
    for (uint i = LOCAL_ID; total != 0u && i < queues; i += (uint)GROUP_SIZE)
        counts[i] = share_of_queue(i, total, queues);
}
