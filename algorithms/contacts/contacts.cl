// SPDX-License-Identifier: MIT
// Contacts between candidate pairs: 2 words (pair, feature) and 8 reals (point, normal, depth, 0) each.
// README.md here has the rule.
#include "backends/portable.h"

#include "algorithms/contacts/trial.clh"

// A work-group's pairs that wait for a step, so that work-items which step together all have work. The whole
// group takes the same step although warps could go their own ways: they would evict each other's
// instructions, of which there are more than a cache for them holds (measured: 1.5 times slower).
#define WAITING (2 * GROUP_SIZE)

// Which step a group takes next: one with work for all of it, from the end of a pair's way back to its
// beginning, or, when no more will come, with any.
#define STEP_NONE 0
#define STEP_CERTIFY 1
#define STEP_TRY 2
#define STEP_CONTACTS 3

DEVICE int next_step(uint open, uint meeting, int last) {
    if (meeting >= (uint)GROUP_SIZE) return STEP_CONTACTS;
    if (open >= (uint)GROUP_SIZE) return STEP_TRY;
    if (!last) return STEP_CERTIFY;
    if (open != 0u) return STEP_TRY;
    return meeting != 0u ? STEP_CONTACTS : STEP_NONE;
}

// What is counted in a group's local memory.
#define COUNT_OPEN 0
#define COUNT_MEETING 1
#define COUNT_CONTACTS 2 // of the pairs of a step
#define FIRST_CONTACT 3  // where they go
#define COUNTS 4

DEVICE void keep_open(LOCAL uint* counts, LOCAL uint* pairs, LOCAL int* edges, uint index, int edge) {
    const uint slot = LOCAL_ATOMIC_ADD(counts + COUNT_OPEN, 1u);
    pairs[slot] = index;
    edges[slot] = edge;
}

// PoCL 3.1 loses what work-items have kept when they meet inside a branch, uniform as it is: there, and where
// a group is one work-item, each pair adds to the counter by itself.
#if defined(__CUDACC__) || defined(__NV_CL_C_VERSION)
#define GROUP_COUNTS 1
#else
#define GROUP_COUNTS 0
#endif

// Where the contacts of a work-item's pair go, those of a group in one piece; the whole group comes here.
DEVICE ulong place_contacts(uint count, LOCAL uint* counts, GLOBAL uint* status) {
#if GROUP_COUNTS
    const uint before = count != 0u ? LOCAL_ATOMIC_ADD(counts + COUNT_CONTACTS, count) : 0u;
    BARRIER;
    if (LOCAL_ID == 0u) {
        counts[FIRST_CONTACT] = counter_add(status + STATUS_CONTACTS, counts[COUNT_CONTACTS]);
        counts[COUNT_CONTACTS] = 0u;
    }
    BARRIER;
    return (ulong)counts[FIRST_CONTACT] + before;
#else
    (void)counts;
    return count != 0u ? counter_add(status + STATUS_CONTACTS, count) : 0u;
#endif
}

// Contacts of a pair of each `active` work-item; the whole group comes here.
DEVICE void make_contacts(const Candidates* all, int active, uint index, LOCAL uint* counts,
                          const Sink* sink) {
    Draft draft;
    draft.count = 0u;
    if (active) draft_contacts(all, index, &draft);
    const ulong slot = place_contacts(draft.count, counts, sink->status);
    if (draft.count != 0u) write_contacts(&draft, index, slot, sink);
}

// Three steps, each for the pairs that the one before could not settle. `verdicts` are read when DECIDED
// only; a pair that is not known to be apart then counts as one that meets.
KERNEL void generate_contacts(GLOBAL const uint* found, uint first, uint pair_capacity,
                              GLOBAL const uint* bodies, GLOBAL const real* poses,
                              GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                              GLOBAL const uchar* boundary, GLOBAL uint* contact_ids,
                              GLOBAL real* contact_values, uint contact_capacity,
                              GLOBAL const uchar* verdicts, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, open_pairs, WAITING);
    LOCAL_ARRAY(int, open_edges, WAITING);
    LOCAL_ARRAY(uint, meeting_pairs, WAITING);
    LOCAL_ARRAY(uint, counts, COUNTS);
    const Candidates all = {found, bodies, poses, tetrahedra, vertices, boundary};
    const Sink sink = {contact_ids, contact_values, status, contact_capacity};
    uint degenerate = 0;
    uint rejected = 0;
    int step = STEP_NONE;
    const ulong count = stored(status + STATUS_PAIRS, pair_capacity);
    ulong start = (ulong)first + GROUP_ID * (uint)GROUP_SIZE;
    if (LOCAL_ID == 0u) counts[COUNT_OPEN] = counts[COUNT_MEETING] = counts[COUNT_CONTACTS] = 0u;
    BARRIER;
    do {
        const uint open_count = counts[COUNT_OPEN];
        const uint meeting_count = counts[COUNT_MEETING];
        step = next_step(open_count, meeting_count, start >= count);
        const uint held = step == STEP_TRY ? open_count : meeting_count;
        const uint left = held > (uint)GROUP_SIZE ? held - (uint)GROUP_SIZE : 0u; // the last ones are taken
        const uint place = left + LOCAL_ID;
        const int active = step == STEP_CERTIFY ? start + LOCAL_ID < count : place < held;
        int state = STEPPED;
        uint index = 0;
        int edge = -1;
        BARRIER;
        if (step == STEP_CERTIFY) {
            index = (uint)(start + LOCAL_ID);
            if (active) {
                const int apart = DECIDED && verdicts[index] == VERDICT_APART;
                state = apart ? REJECTED : try_certificate(&all, index, &edge);
            }
            start += GLOBAL_COUNT;
        } else if (step == STEP_TRY) {
            if (active) {
                index = open_pairs[place];
                state = try_all(&all, index, open_edges[place]);
            }
            if (LOCAL_ID == 0u) counts[COUNT_OPEN] = left;
        } else if (step == STEP_CONTACTS) {
            if (active) index = meeting_pairs[place];
            make_contacts(&all, active, index, counts, &sink);
            if (LOCAL_ID == 0u) counts[COUNT_MEETING] = left;
        }
        degenerate += state == DEGENERATE ? 1u : 0u;
        rejected += state == REJECTED ? 1u : 0u;
        if (state == OPEN) keep_open(counts, open_pairs, open_edges, index, edge);
        if (state == MEETING && !has_no_normal(&all, index))
            meeting_pairs[LOCAL_ATOMIC_ADD(counts + COUNT_MEETING, 1u)] = index;
        BARRIER;
    } while (step != STEP_NONE);
    if (degenerate != 0u) counter_add(status + STATUS_DEGENERATE, degenerate);
    if (rejected != 0u) counter_add(status + STATUS_REJECTED, rejected);
}

// The term of a contact in the digest: that of its pair, then the feature, then the bits of its reals, two
// words at a time.
DEVICE ulong contact_term(ulong pair_term, uint feature, GLOBAL const uint* bits) {
    ulong term = mix(pair_term + feature);
    for (int i = 0; i < CONTACT_BITS; i += 2) term = mix(term + (((ulong)bits[i + 1] << 32) | bits[i]));
    return term;
}

// Adds the terms of the first `count` contacts to `sums`. `value_bits`: their values as words. `ids`:
// tetrahedra in input order.
KERNEL void digest_contacts(GLOBAL const uint* found, GLOBAL const uint* bodies, GLOBAL const uint* ids,
                            GLOBAL const uint* contact_ids, GLOBAL const uint* value_bits, uint count,
                            GLOBAL uint* sums) {
    ulong a = 0;
    ulong b = 0;
    for (ulong i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        GLOBAL const uint* contact = contact_ids + i * CONTACT_WORDS;
        GLOBAL const uint* row = found + (ulong)contact[0] * PAIR_WORDS;
        const uint tet_a = ids[bodies[(ulong)row[0] * BODY_WORDS + BODY_TETRAHEDRA] + row[2]];
        const uint tet_b = ids[bodies[(ulong)row[1] * BODY_WORDS + BODY_TETRAHEDRA] + row[3]];
        const ulong pair_term = digest_a(row[0], tet_a, row[1], tet_b);
        const ulong term = contact_term(pair_term, contact[1], value_bits + i * CONTACT_BITS);
        a += term;
        b += digest_b(term);
    }
    add_to_sums(sums, a, b);
}
