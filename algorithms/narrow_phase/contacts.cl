// SPDX-License-Identifier: MIT
// Contacts between candidate pairs: 2 words (pair, feature) and 8 reals (point, normal, depth, 0) each.
// README.md describes the rules.
// Host variants: PRECISION
#include "backends/portable.h"

#include "algorithms/narrow_phase/pair_state.clh"
#include "algorithms/narrow_phase/pair_lists.clh"

// State of a pair. `pair`: as in try_all.
DEVICE int try_pair(const Candidates* all, uint index, int apart, LOCAL LocalPair* pair) {
    if (lacks_boundary(all, index)) return PAIR_WITHOUT_BOUNDARY;
    if (apart) return PAIR_REJECTED;
    int edge = -1;
    const int state = try_certificate(all, index, &edge);
    return state == PAIR_OPEN ? try_all(all, index, edge, pair) : state;
}

// Features of a group's pairs wait in a queue, so that all work-items have one, however many a pair has. An
// entry is the number of a work-item, whose pair it is, and that of a feature.
#define QUEUED 8 // features of a work-item that enter at a time
#define FEATURE_BITS 6
#define FEATURE_OF(entry) ((int)((entry) & ((1u << FEATURE_BITS) - 1u)))
#define OWNER_OF(entry) ((entry) >> FEATURE_BITS)

// Words of a group's local memory. They are 0 between calls of make_contacts.
#define QUEUE_END GROUP_OWN        // number of entries in the queue
#define UNFINISHED (GROUP_OWN + 1) // number of work-items with features that are not in the queue yet
#define NEW_CONTACTS (GROUP_OWN + 2)
#define FIRST_ROW (GROUP_OWN + 3) // of the new contacts in the answer

// Moves features of the work-item, one bit each, to the queue; returns the rest.
DEVICE ulong enqueue(ulong features, LOCAL unsigned short* queue, LOCAL uint* group) {
    const uint all = COUNT_ONES(features) + COUNT_ONES(features >> 32);
    const uint count = all < QUEUED ? all : QUEUED;
    const uint before = count != 0u ? LOCAL_ATOMIC_ADD(group + QUEUE_END, count) : 0u;
    for (uint i = 0; i < count; ++i, features &= features - 1)
        queue[before + i] = (unsigned short)(LOCAL_ID << FEATURE_BITS | (uint)lowest(features));
    if (features != 0) LOCAL_ATOMIC_ADD(group + UNFINISHED, 1u);
    return features;
}

// The row of the work-item's contact, if it has one. The whole group must call it. It also empties the queue.
DEVICE ulong row_in_answer(int has_contact, LOCAL uint* group, GLOBAL uint* status) {
    const uint before = has_contact ? LOCAL_ATOMIC_ADD(group + NEW_CONTACTS, 1u) : 0u;
    BARRIER;
    if (LOCAL_ID == 0u) {
        const uint count = group[NEW_CONTACTS];
        group[FIRST_ROW] = count != 0u ? counter_add(status + STATUS_CONTACTS, count) : 0u;
        group[NEW_CONTACTS] = group[QUEUE_END] = group[UNFINISHED] = 0u;
    }
    BARRIER;
    return (ulong)group[FIRST_ROW] + before;
}

// Makes the contacts of a group's pairs. `features`: of the work-item's own pair. The whole group must call
// it.
DEVICE void make_contacts(ulong features, LOCAL const MeetingPair* pairs, LOCAL unsigned short* queue,
                          LOCAL uint* group, const Sink* sink) {
    uint unfinished = 0;
    do {
        features = enqueue(features, queue, group);
        BARRIER;
        const uint end = group[QUEUE_END];
        unfinished = group[UNFINISHED];
        BARRIER;
        for (uint start = 0; start < end; start += GROUP_SIZE) {
            const uint entry = start + LOCAL_ID < end ? queue[start + LOCAL_ID] : 0u;
            LOCAL const MeetingPair* pair = pairs + OWNER_OF(entry);
            LocalContact touch;
            const int has_contact = start + LOCAL_ID < end && touch_of(pair, FEATURE_OF(entry), &touch);
            const ulong row = row_in_answer(has_contact, group, sink->status);
            if (has_contact && row < sink->capacity) write_touch(pair, FEATURE_OF(entry), &touch, row, sink);
        }
    } while (unfinished != 0u);
    BARRIER; // the next pairs replace those that others have just written contacts of
}

// `meeting`: read unless AT_ONCE. `first`, `pair_capacity` and `verdicts`: as in certify_pairs, if AT_ONCE.
KERNEL void generate_contacts(GLOBAL const uint* found, uint first, uint pair_capacity,
                              GLOBAL const uint* owners, GLOBAL const real* poses,
                              GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                              GLOBAL const uchar* boundary, GLOBAL const uchar* verdicts,
                              GLOBAL const uint* meeting, GLOBAL uint* contact_ids,
                              GLOBAL real* contact_values, uint contact_capacity, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, group, GROUP_WORDS);
    LOCAL_ARRAY(MeetingPair, pairs, GROUP_SIZE);
    LOCAL_ARRAY(unsigned short, queue, QUEUED* GROUP_SIZE);
    const Candidates all = {found, owners, poses, tetrahedra, vertices, boundary};
    const Sink sink = {contact_ids, contact_values, status, contact_capacity};
    const ulong count =
        AT_ONCE ? stored(status + STATUS_PAIRS, pair_capacity) : status[STATUS_WAITING + LIST_MEETING];
    ulong start = (AT_ONCE ? (ulong)first : 0u) + GROUP_ID * (uint)GROUP_SIZE;
    begin_group(group);
    do {
        ulong features = 0;
        if (start + LOCAL_ID < count) {
            const uint index = AT_ONCE ? (uint)(start + LOCAL_ID) : meeting[start + LOCAL_ID];
            int state = PAIR_MEETING;
            if (AT_ONCE) {
                const int apart = KNOWN_APART(verdicts, index);
                state = try_pair(&all, index, apart, &pairs[LOCAL_ID].pair);
                count_state(state, group);
            }
            if (state == PAIR_MEETING) features = prepare_contacts(&all, index, pairs + LOCAL_ID);
        }
        make_contacts(features, pairs, queue, group, &sink);
        start += GLOBAL_COUNT;
    } while (start < count);
    if (AT_ONCE) end_group(group, status);
}
