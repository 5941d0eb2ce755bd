// SPDX-License-Identifier: MIT
// Contacts between candidate pairs: 2 words (pair, feature) and 8 reals (point, normal, depth, 0) each.
// README.md here has the rule.
#include "backends/portable.h"

#include "algorithms/contacts/axes.clh"
#include "algorithms/contacts/candidates.clh"
#include "algorithms/contacts/clipping.clh"
#include "algorithms/contacts/consistent.clh"
#include "algorithms/contacts/published.clh"

// Whether filter.cl and recheck.cl have written verdicts.
#ifndef DECIDED
#define DECIDED 0
#endif
#ifndef CONTACT_RULE
#define CONTACT_RULE 0
#endif
// Rules that take the pair in canonical order; the others take it as it is named.
#define IS_CANONICAL (CONTACT_RULE >= RULE_SAT)
// Rules whose contacts have a normal and a depth each.
#define IS_POINTWISE (CONTACT_RULE == RULE_VERTEX || CONTACT_RULE == RULE_CONSISTENT)
// Rules that want a boundary face of either; those that are not canonical want one of both.
#define WANTS_A_BOUNDARY (IS_POINTWISE || CONTACT_RULE == RULE_RESTRICTED)

#define CONTACT_WORDS 2
#define CONTACT_REALS 8
#define CONTACT_BITS (CONTACT_REALS * PRECISION / 32) // words of its reals

// Where contacts go.
typedef struct {
    GLOBAL uint* ids;
    GLOBAL real* values;
    GLOBAL uint* status;
    uint capacity;
} Sink;

// Negative zero becomes positive: equal contacts then have equal bits.
DEVICE void write_contact(const Encounter* pair, Point normal, Point at, real depth, GLOBAL real* value) {
    const Point p = over(at, pair->scale);
    value[0] = (p.x + pair->origin.x) + (real)0;
    value[1] = (p.y + pair->origin.y) + (real)0;
    value[2] = (p.z + pair->origin.z) + (real)0;
    value[3] = normal.x + (real)0;
    value[4] = normal.y + (real)0;
    value[5] = normal.z + (real)0;
    value[6] = depth / pair->scale + (real)0;
    value[7] = 0;
}

// The features that can make a contact, a bit each. `boundary`: bits 0..3 the boundary faces of A, 4..7 of B.
DEVICE ulong candidate_features(const Encounter* pair, uint boundary) {
    if (CONTACT_RULE == RULE_VERTEX) return vertex_features(pair, boundary);
    if (CONTACT_RULE == RULE_CONSISTENT) return consistent_features(pair, boundary);
    return CONTACT_RULE == RULE_PUBLISHED ? published_features(pair) : features_of(pair);
}

// A contact as it will be written; its point is local.
typedef struct {
    Point point, normal;
    real depth;
} Touch;

// Whether one of candidate_features makes a contact, and which.
DEVICE int touch_at(const Encounter* pair, const Support* support, uint boundary, int swapped, int feature,
                    Touch* touch) {
    if (!IS_POINTWISE) {
        touch->normal = support->normal;
        const int kept = contact_at(pair, support, feature, &touch->point, &touch->depth);
        if (IS_CANONICAL) touch->depth = support->depth;
        return kept;
    }
    if (CONTACT_RULE == RULE_VERTEX)
        vertex_contact(pair, boundary, feature, &touch->point, &touch->normal, &touch->depth);
    else
        consistent_contact(pair, feature, &touch->point, &touch->normal, &touch->depth);
    if (swapped) touch->normal = times(touch->normal, (real)-1);
    return 1;
}

// Finds which features make contacts, reserves room for all of them at once, and writes what fits.
DEVICE void append_contacts(const Encounter* pair, const Support* support, uint boundary, Naming naming,
                            uint index, const Sink* sink) {
    Touch touch;
    ulong kept = 0;
    uint count = 0;
    for (ulong rest = candidate_features(pair, boundary); rest != 0; rest &= rest - 1) {
        if (!touch_at(pair, support, boundary, naming.swapped, lowest(rest), &touch)) continue;
        kept |= rest & (~rest + 1);
        ++count;
    }
    if (count == 0u) return;
    ulong slot = counter_add(sink->status + STATUS_CONTACTS, count);
    for (ulong rest = kept; rest != 0 && slot < sink->capacity; rest &= rest - 1) {
        const int feature = lowest(rest);
        touch_at(pair, support, boundary, naming.swapped, feature, &touch);
        sink->ids[slot * CONTACT_WORDS] = index;
        sink->ids[slot * CONTACT_WORDS + 1] = (uint)(IS_CANONICAL ? given_feature(naming, feature) : feature);
        write_contact(pair, touch.normal, touch.point, touch.depth, sink->values + slot * CONTACT_REALS);
        ++slot;
    }
}

// What became of a pair.
#define DEGENERATE 0
#define REJECTED 1
#define INNER 2 // no contacts for want of boundary faces
#define UNDECIDED 3

DEVICE int try_normals(const Candidates* all, uint index) {
    Point a[4];
    Point b[4];
    Point normal[4];
    Encounter pair;
    load_pair(all, index, a, b);
    if (IS_CANONICAL) canonical(a, b);
    if (!meet(a, b, &pair) || !find_normals(a, normal)) return DEGENERATE;
    const int apart = DECIDED ? 0 : normals_separate(&pair, normal);
    if (!find_normals(b, normal)) return DEGENERATE;
    return !DECIDED && (apart || normals_separate(&pair, normal)) ? REJECTED : UNDECIDED;
}

// The boundary faces of A, then of B, a bit each.
DEVICE uint boundaries_of(const Candidates* all, uint index) {
    GLOBAL const uint* row = all->found + (ulong)index * PAIR_WORDS;
    return boundary_of(all, row[0], row[2]) | boundary_of(all, row[1], row[3]) << 4;
}

// Without the boundary faces that a rule asks for it has no normal and nothing is left to do.
DEVICE int has_no_normal(const Candidates* all, uint index) {
    if (WANTS_A_BOUNDARY) return boundaries_of(all, index) == 0u;
    if (IS_CANONICAL) return 0;
    const uint boundary = boundaries_of(all, index);
    return (boundary & 15u) == 0u || boundary >> 4 == 0u;
}

DEVICE int try_edges(const Candidates* all, uint index) {
    Point a[4];
    Point b[4];
    Encounter pair;
    if (!DECIDED) {
        load_pair(all, index, a, b);
        if (IS_CANONICAL) canonical(a, b);
        meet(a, b, &pair);
        if (edges_separate(&pair)) return REJECTED;
    }
    return has_no_normal(all, index) ? INNER : UNDECIDED;
}

// What gives all contacts of a pair their normal, in its own order.
DEVICE Support support_of(const Encounter* pair, const Point* a, const Point* b, uint boundary) {
    if (IS_POINTWISE) return whole_support(pair);
    if (!IS_CANONICAL) {
        Support support = support_at(pair, opposing_face(pair, boundary & 15u, boundary >> 4));
        if (CONTACT_RULE == RULE_PUBLISHED) loosen(pair, &support);
        return support;
    }
    const Axes axes = CONTACT_RULE == RULE_RESTRICTED ? boundary_axes(boundary) : all_axes();
    Support support = best_axis(pair, a, b, axes, CONTACT_RULE == RULE_GROWTH && !is_concentric(pair));
    if (CONTACT_RULE == RULE_CLIP) clip_support(pair, &support);
    if (CONTACT_RULE == RULE_GROWTH) support.depth = (real)0 - common_extent(pair, &support);
    return support;
}

DEVICE void make_contacts(const Candidates* all, uint index, const Sink* sink) {
    Point a[4];
    Point b[4];
    Encounter pair;
    load_pair(all, index, a, b);
    uint boundary = boundaries_of(all, index);
    Naming naming = {0u, 0u, 0};
    if (IS_CANONICAL) {
        naming = canonical(a, b);
        boundary = canonical_faces(naming, boundary);
    }
    meet(a, b, &pair);
    find_normals(a, pair.solid[0].normal);
    find_normals(b, pair.solid[1].normal);
    NO_UNROLL for (int i = 0; i < 8; ++i) pair.solid[i / 4].normal[i % 4] =
        unit(pair.solid[i / 4].normal[i % 4]);
    Support support = support_of(&pair, a, b, boundary);
    if (naming.swapped) support.normal = times(support.normal, (real)-1);
    append_contacts(&pair, &support, boundary, naming, index, sink);
}

// A work-group's pairs that wait for the next step, so that work-items which step together all have work.
#define WAITING (2 * GROUP_SIZE)

DEVICE void put(LOCAL uint* queue, uint index) {
    const uint slot = LOCAL_ATOMIC_ADD(queue + WAITING, 1u);
    queue[slot] = index;
}

// How many are taken, from the end: a full group's worth, or, when no more will come, all.
DEVICE uint taken(uint held, int last) {
    if (held >= (uint)GROUP_SIZE) return GROUP_SIZE;
    return last ? held : 0u;
}

// Three steps, each for the pairs that the one before could not settle. `verdicts` are read when DECIDED
// only; a pair that is not known to be apart then counts as one that meets.
KERNEL void generate_contacts(GLOBAL const uint* found, uint first, uint pair_capacity,
                              GLOBAL const uint* bodies, GLOBAL const real* poses,
                              GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                              GLOBAL const uchar* boundary, GLOBAL uint* contact_ids,
                              GLOBAL real* contact_values, uint contact_capacity,
                              GLOBAL const uchar* verdicts, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, for_edges, WAITING + 1);
    LOCAL_ARRAY(uint, for_contacts, WAITING + 1);
    const Candidates all = {found, bodies, poses, tetrahedra, vertices, boundary};
    const Sink sink = {contact_ids, contact_values, status, contact_capacity};
    uint degenerate = 0;
    uint rejected = 0;
    uint waiting = 0;
    int last = 0;
    const ulong count = stored(status + STATUS_PAIRS, pair_capacity);
    ulong start = (ulong)first + GROUP_ID * (uint)GROUP_SIZE;
    if (LOCAL_ID == 0u) for_edges[WAITING] = for_contacts[WAITING] = 0u;
    BARRIER;
    do {
        last = start >= count;
        if (start + LOCAL_ID < count) {
            const uint index = (uint)(start + LOCAL_ID);
            const int apart = DECIDED && verdicts[index] == VERDICT_APART;
            const int state = apart ? REJECTED : try_normals(&all, index);
            degenerate += state == DEGENERATE ? 1u : 0u;
            rejected += state == REJECTED ? 1u : 0u;
            if (state == UNDECIDED) put(for_edges, index);
        }
        start += GLOBAL_COUNT;
        BARRIER;
        const uint edges = for_edges[WAITING];
        const uint edges_left = edges - taken(edges, last);
        BARRIER;
        if (LOCAL_ID < edges - edges_left) {
            const uint index = for_edges[edges_left + LOCAL_ID];
            const int state = try_edges(&all, index);
            rejected += state == REJECTED ? 1u : 0u;
            if (state == UNDECIDED) put(for_contacts, index);
        }
        if (LOCAL_ID == 0u) for_edges[WAITING] = edges_left;
        BARRIER;
        const uint contacts = for_contacts[WAITING];
        const uint contacts_left = contacts - taken(contacts, last && edges_left == 0u);
        BARRIER;
        if (LOCAL_ID < contacts - contacts_left)
            make_contacts(&all, for_contacts[contacts_left + LOCAL_ID], &sink);
        if (LOCAL_ID == 0u) for_contacts[WAITING] = contacts_left;
        waiting = edges_left + contacts_left;
        BARRIER;
    } while (!last || waiting != 0u);
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
