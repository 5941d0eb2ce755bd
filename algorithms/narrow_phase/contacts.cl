// SPDX-License-Identifier: MIT
// Contacts between candidate pairs: 2 words (pair, feature) and 8 reals (point, normal, depth, 0) each.
// README.md describes the rules.
// Host variants: PRECISION, in lanes
#define IN_PACKS
#include "backends/portable.h"

#include "algorithms/narrow_phase/pair_state.clh"
#include "algorithms/narrow_phase/pair_lists.clh"

// States of pairs. `pair`: as in try_all.
DEVICE uints try_pair(const Candidates* all, uints index, flags apart, LOCAL LocalPair* pair) {
    flags lacks = NEVER;
    if (BOUNDARY_NEEDED != 0) {
        uints without = SAME_WORD(0);
        FOR_PACK(i) AT(without, i) = lacks_boundary(all, (uint)AT(index, i));
        lacks = without != 0u;
    }
    uints state = lacks ? SAME_WORD(PAIR_WITHOUT_BOUNDARY) : SAME_WORD(PAIR_REJECTED);
    const flags asked = NOT(lacks | apart);
    if (!ANY(asked)) return state;
    uints edge = SAME_WORD(0);
    const uints by_certificate = try_certificate(all, index, &edge);
    state = asked ? by_certificate : state;
    const flags open = state == (uint)PAIR_OPEN;
    if (ANY(open)) state = open ? try_all(all, index, open, edge, pair) : state;
    return state;
}

#if PACK > 1
// A group's contacts wait in its own memory, so that the shared counter and the answer are written for many
// at once.
#define BATCH_CAPACITY 256
typedef struct {
    uint count;
    ContactIds ids[BATCH_CAPACITY];
    RealRow values[2 * BATCH_CAPACITY];
} ContactBatch;

DEVICE void hand_out(ContactBatch* batch, const Sink* sink) {
    if (batch->count == 0u) return;
    const ulong row = counter_add(sink->status + STATUS_CONTACTS, batch->count);
    const ulong room = row < sink->capacity ? sink->capacity - row : 0;
    const uint fitting = batch->count < room ? batch->count : (uint)room;
    for (uint i = 0; i < fitting; ++i) {
        ((GLOBAL ContactIds*)sink->ids)[row + i] = batch->ids[i];
        ((GLOBAL RealRow*)sink->values)[2 * (row + i)] = batch->values[2 * i];
        ((GLOBAL RealRow*)sink->values)[2 * (row + i) + 1] = batch->values[2 * i + 1];
    }
    batch->count = 0;
}

// Makes the contacts of a pack of pairs: of each pair one feature after the other.
DEVICE void make_contacts(Features features, const MeetingPair* pair, ContactBatch* batch, const Sink* sink) {
    for (;;) {
        const flags asked = has_features(features);
        if (!ANY(asked)) return;
        const uints feature = lowest_feature(features);
        features = without_lowest(features);
        LocalContact touch;
        const flags kept = asked & touch_of(pair, feature, &touch);
        if (!ANY(kept)) continue;
        if (batch->count + PACK > BATCH_CAPACITY) hand_out(batch, sink);
        const uints written = written_feature(pair, feature);
        FOR_PACK(i) {
            if (kept[i] == 0) continue;
            write_touch(pair, written, &touch, i, (uint*)&batch->ids[batch->count],
                        batch->values + 2 * batch->count);
            ++batch->count;
        }
    }
}
#else
// Features of a group's pairs wait in a queue, so that all work-items have one, however many a pair has. An
// entry is the number of a work-item, whose pair it is, and that of a feature.
#define QUEUED 8 // features of a work-item that enter at a time
#define FEATURE_BITS 6
#define FEATURE_OF(entry) ((entry) & ((1u << FEATURE_BITS) - 1u))
#define OWNER_OF(entry) ((entry) >> FEATURE_BITS)

// Words of a group's local memory. They are 0 between calls of make_contacts.
#define QUEUE_END GROUP_OWN        // number of entries in the queue
#define UNFINISHED (GROUP_OWN + 1) // number of work-items with features that are not in the queue yet
#define NEW_CONTACTS (GROUP_OWN + 2)
#define FIRST_ROW (GROUP_OWN + 3) // of the new contacts in the answer

// Moves features of the work-item, one bit each, to the queue; returns the rest.
DEVICE Features enqueue(Features features, LOCAL unsigned short* queue, LOCAL uint* group) {
    const uint all = COUNT_ONES(features.low) + COUNT_ONES(features.high);
    const uint count = all < QUEUED ? all : QUEUED;
    const uint before = count != 0u ? LOCAL_ATOMIC_ADD(group + QUEUE_END, count) : 0u;
    for (uint i = 0; i < count; ++i, features = without_lowest(features))
        queue[before + i] = (unsigned short)(LOCAL_ID << FEATURE_BITS | lowest_feature(features));
    if (has_features(features)) LOCAL_ATOMIC_ADD(group + UNFINISHED, 1u);
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
DEVICE void make_contacts(Features features, LOCAL const MeetingPair* pairs, LOCAL unsigned short* queue,
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
            if (has_contact && row < sink->capacity)
                write_touch(pair, written_feature(pair, FEATURE_OF(entry)), &touch, 0,
                            sink->ids + row * CONTACT_WORDS,
                            (GLOBAL RealRow*)(sink->values + row * CONTACT_REALS));
        }
    } while (unfinished != 0u);
    BARRIER; // the next pairs replace those that others have just written contacts of
}
#endif

// `meeting`: read unless AT_ONCE. `first`, `pair_capacity` and `verdicts`: as in certify_pairs, if AT_ONCE.
KERNEL void generate_contacts(GLOBAL const uint* found, uint first, uint pair_capacity,
                              GLOBAL const uint* owners, GLOBAL const real* poses,
                              GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                              GLOBAL const uchar* boundary, GLOBAL const uchar* verdicts,
                              GLOBAL const uint* meeting, GLOBAL uint* contact_ids,
                              GLOBAL real* contact_values, uint contact_capacity, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, group, GROUP_WORDS);
    LOCAL_ARRAY(MeetingPair, pairs, GROUP_SIZE);
#if PACK > 1
    ContactBatch batch;
    batch.count = 0;
#else
    LOCAL_ARRAY(unsigned short, queue, QUEUED* GROUP_SIZE);
#endif
    const Candidates all = {found, owners, poses, tetrahedra, vertices, boundary};
    const Sink sink = {contact_ids, contact_values, status, contact_capacity};
    const ulong count =
        AT_ONCE ? rows_in(status + STATUS_PAIRS, pair_capacity) : status[STATUS_WAITING + LIST_MEETING];
    ulong start = (AT_ONCE ? (ulong)first : 0u) + (GROUP_ID * (uint)GROUP_SIZE) * PACK;
    begin_group(group);
    do {
        Features features = {SAME_WORD(0), SAME_WORD(0)};
        const ulong base = start + LOCAL_ID * PACK;
        const uint present = elements_below(base, count);
        if (present != 0u) {
            const uints index =
                AT_ONCE ? numbers_from((uint)base, present) : entries_of(meeting, base, present);
            flags meets = first_elements(present);
            if (AT_ONCE) {
                const uints state =
                    try_pair(&all, index, known_apart(verdicts, index), &pairs[LOCAL_ID].pair);
                count_state(meets ? state : SAME_WORD(PAIR_ABSENT), group);
                meets &= state == (uint)PAIR_MEETING;
            }
            if (ANY(meets)) features = prepare_contacts(&all, index, pairs + LOCAL_ID);
            features.low = meets ? features.low : SAME_WORD(0);
            features.high = meets ? features.high : SAME_WORD(0);
        }
#if PACK > 1
        make_contacts(features, pairs, &batch, &sink);
#else
        make_contacts(features, pairs, queue, group, &sink);
#endif
        start += GLOBAL_COUNT * PACK;
    } while (start < count);
#if PACK > 1
    hand_out(&batch, &sink);
#endif
    if (AT_ONCE) end_group(group, status);
}
