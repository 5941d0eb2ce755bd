// SPDX-License-Identifier: MIT
// Contacts between candidate pairs: 2 words (pair, feature) and 8 reals (point, normal, depth, 0) each.
// README.md here has the rule.
#include "backends/portable.h"

#include "algorithms/contacts/opposing.clh"
#include "algorithms/contacts/separation.clh"
#include "algorithms/pairs.clh"

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

// How many of the counted are really in the buffer.
DEVICE uint stored(GLOBAL const uint* counter, uint capacity) {
    return counter[1] != 0u || counter[0] > capacity ? capacity : counter[0];
}

DEVICE void load_corners(GLOBAL const uint* body, GLOBAL const real* pose, GLOBAL const uint* tetrahedra,
                         GLOBAL const real* vertices, uint item, Point* corner) {
    for (uint i = 0; i < 4u; ++i) corner[i] = corner_at(body, pose, tetrahedra, vertices, item, i);
}

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

// Finds which features make contacts, reserves room for all of them at once, and writes what fits.
DEVICE void append_contacts(const Encounter* pair, int face, uint index, const Sink* sink) {
    const Support support = support_at(&pair->solid[0], face);
    Point p;
    real depth;
    ulong kept = 0;
    uint count = 0;
    for (int feature = 0; feature < FEATURES; ++feature) {
        if (!contact_at(pair, &support, feature, &p, &depth)) continue;
        kept |= (ulong)1 << feature;
        ++count;
    }
    if (count == 0u) return;
    ulong slot = counter_add(sink->status + STATUS_CONTACTS, count);
    for (int feature = 0; feature < FEATURES && slot < sink->capacity; ++feature) {
        if (((kept >> feature) & 1u) == 0u) continue;
        contact_at(pair, &support, feature, &p, &depth);
        sink->ids[slot * CONTACT_WORDS] = index;
        sink->ids[slot * CONTACT_WORDS + 1] = (uint)feature;
        write_contact(pair, support.normal, p, depth, sink->values + slot * CONTACT_REALS);
        ++slot;
    }
}

KERNEL void generate_contacts(GLOBAL const uint* found, uint first, uint pair_capacity,
                              GLOBAL const uint* bodies, GLOBAL const real* poses,
                              GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                              GLOBAL const uchar* boundary, GLOBAL uint* contact_ids,
                              GLOBAL real* contact_values, uint contact_capacity, GLOBAL uint* status) {
    Sink sink;
    sink.ids = contact_ids;
    sink.values = contact_values;
    sink.status = status;
    sink.capacity = contact_capacity;
    uint degenerate = 0;
    uint rejected = 0;
    const ulong count = stored(status + STATUS_PAIRS, pair_capacity);
    for (ulong i = (ulong)first + GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        GLOBAL const uint* row = found + i * PAIR_WORDS;
        GLOBAL const uint* body_a = bodies + (ulong)row[0] * BODY_WORDS;
        GLOBAL const uint* body_b = bodies + (ulong)row[1] * BODY_WORDS;
        Point a[4];
        Point b[4];
        load_corners(body_a, poses + (ulong)row[0] * 12, tetrahedra, vertices, row[2], a);
        load_corners(body_b, poses + (ulong)row[1] * 12, tetrahedra, vertices, row[3], b);
        Encounter pair;
        if (!meet(a, b, &pair)) {
            ++degenerate;
        } else if (are_separated(&pair)) {
            ++rejected;
        } else {
            const int face = opposing_face(&pair, boundary[body_a[BODY_TETRAHEDRA] + row[2]],
                                           boundary[body_b[BODY_TETRAHEDRA] + row[3]]);
            if (face == NO_FACE) continue;
            measure(&pair);
            append_contacts(&pair, face, (uint)i, &sink);
        }
    }
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

// Digest of the contacts that are in the buffer. `value_bits`: their values as words. `ids`: tetrahedra in
// input order.
KERNEL void digest_contacts(GLOBAL const uint* found, GLOBAL const uint* bodies, GLOBAL const uint* ids,
                            GLOBAL const uint* contact_ids, GLOBAL const uint* value_bits,
                            uint contact_capacity, GLOBAL uint* status) {
    ulong a = 0;
    ulong b = 0;
    const ulong count = stored(status + STATUS_CONTACTS, contact_capacity);
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
    if (a != 0 || b != 0) {
        counter_add_wide(status + STATUS_CONTACT_DIGEST_A, a);
        counter_add_wide(status + STATUS_CONTACT_DIGEST_B, b);
    }
}
