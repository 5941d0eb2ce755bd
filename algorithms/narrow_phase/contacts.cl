// SPDX-License-Identifier: MIT
// Contacts between candidate pairs: 2 words (pair, feature) and 8 reals (point, normal, depth, 0) each.
// README.md describes the rules.
// Host variants: PRECISION, in lanes
#define IN_PACKS
#include "backends/portable.h"

#include "algorithms/narrow_phase/pair_state.clh"
#include "algorithms/narrow_phase/pair_lists.clh"
#if PACK == 1
#include "algorithms/narrow_phase/contact_queue.clh"
#endif

// States of pairs. `pair`: as in try_all.
DEVICE uints try_pair(const Candidates* all, uints index, flags apart, float margin, LOCAL LocalPair* pair) {
    flags lacks = NEVER;
    if (BOUNDARY_NEEDED + PRESSURES_NEEDED != 0) {
        uints without = SAME_WORD(0);
        FOR_PACK(i) AT(without, i) = is_without_contact(all, (uint)AT(index, i));
        lacks = without != 0u;
    }
    uints state = lacks ? SAME_WORD(STATE_LEFT_OUT) : SAME_WORD(PAIR_REJECTED);
    const flags asked = NOT(lacks) & (WANTS_NEAR ? ALWAYS : NOT(apart));
    if (!ANY(asked)) return state;
    uints edge = SAME_WORD(0);
    const uints by_certificate = try_certificate(all, index, apart, margin, &edge);
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

DEVICE void write_batch(ContactBatch* batch, const Sink* sink) {
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
        if (batch->count + PACK > BATCH_CAPACITY) write_batch(batch, sink);
        const uints written = written_feature(pair, feature);
        FOR_PACK(i) {
            if (kept[i] == 0) continue;
            write_touch(pair, written, &touch, i, (uint*)&batch->ids[batch->count],
                        batch->values + 2 * batch->count);
            ++batch->count;
        }
    }
}
#endif

// Whether certify_pairs and separate_pairs have not counted the states of all pairs.
#define COUNTS_STATES (AT_ONCE || HAS_FIELD)

// Counts pairs that might have polygons and have none.
DEVICE void count_polygons(Features features, flags wanted, LOCAL const MeetingPair* meeting,
                           LOCAL uint* group) {
    if (!HAS_FIELD) return;
    uints state = meeting->support.near > (real)0 ? SAME_WORD(PAIR_MEETING) : SAME_WORD(PAIR_REJECTED);
    state = features.low == 0u ? SAME_WORD(PAIR_DEGENERATE) : state;
    count_state(wanted ? state : SAME_WORD(PAIR_ABSENT), group);
}

// The pairs of a launch: those that meet, then, from a group's first place on, near ones, because a group's
// pairs should take the same way.
typedef struct {
    ulong end_meeting, first_near, end;
} PairRange;

DEVICE PairRange pair_range(GLOBAL uint* status, uint pair_capacity) {
    PairRange range;
    range.end_meeting =
        AT_ONCE ? rows_in(status + STATUS_PAIRS, pair_capacity) : status[STATUS_WAITING + LIST_MEETING];
    range.first_near = ~(ulong)0;
    range.end = range.end_meeting;
    if (!WANTS_NEAR || AT_ONCE) return range;
    const ulong places = GROUP_SIZE * PACK;
    range.first_near = (range.end_meeting + places - 1u) / places * places;
    range.end = range.first_near + status[STATUS_WAITING + LIST_NEAR];
    return range;
}

// `meeting` and `near`: read unless AT_ONCE. `margin`: as in certify_pairs. `first`, `pair_capacity` and
// `verdicts`: as in certify_pairs, if AT_ONCE.
KERNEL void generate_contacts(GLOBAL const uint* found, uint first, uint pair_capacity,
                              GLOBAL const uint* owners, GLOBAL const real* poses,
                              GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                              GLOBAL const uchar* boundary, GLOBAL const uchar* verdicts, float margin,
                              GLOBAL const uint* meeting, GLOBAL const uint* near, GLOBAL uint* contact_ids,
                              GLOBAL real* contact_values, uint contact_capacity, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, group, GROUP_WORDS);
    LOCAL_ARRAY(MeetingPair, pairs, GROUP_SIZE);
#if PACK > 1
    ContactBatch batch;
    batch.count = 0;
#else
    CONTACT_TEAM(team);
#endif
    const Candidates all = {found, owners, poses, tetrahedra, vertices, boundary};
    const Sink sink = {contact_ids, contact_values, status, contact_capacity};
    const PairRange range = pair_range(status, pair_capacity);
    ulong start = (AT_ONCE ? (ulong)first : 0u) + (GROUP_ID * (uint)GROUP_SIZE) * PACK;
    begin_group(group);
    do {
        Features features = {SAME_WORD(0), SAME_WORD(0)};
        const ulong base = start + LOCAL_ID * PACK;
        const int is_near = WANTS_NEAR && base >= range.first_near;
        const uint present = elements_below(base, is_near ? range.end : range.end_meeting);
        if (present != 0u) {
            const uints index = AT_ONCE   ? numbers_from((uint)base, present)
                                : is_near ? entries_of(near, base - range.first_near, present)
                                          : entries_of(meeting, base, present);
            flags wanted = first_elements(present);
            flags apart = is_near ? ALWAYS : NEVER;
            if (AT_ONCE) {
                const uints state =
                    try_pair(&all, index, known_apart(verdicts, index), margin, &pairs[LOCAL_ID].pair);
                count_state(wanted ? state : SAME_WORD(PAIR_ABSENT), group);
                apart = state == (uint)PAIR_NEAR;
                wanted &= apart | (state == (uint)PAIR_MEETING);
            }
            if (ANY(wanted)) features = prepare_contacts(&all, index, apart, margin, pairs + LOCAL_ID);
            features.low = wanted ? features.low : SAME_WORD(0);
            features.high = wanted ? features.high : SAME_WORD(0);
            count_polygons(features, wanted, pairs + LOCAL_ID, group);
        }
#if PACK > 1
        make_contacts(features, pairs, &batch, &sink);
#else
        make_contacts(features, pairs, &team, &sink);
#endif
        start += GLOBAL_COUNT * PACK;
    } while (start < range.end);
#if PACK > 1
    write_batch(&batch, &sink);
#endif
    BARRIER;
    if (COUNTS_STATES) end_group(group, status);
}
