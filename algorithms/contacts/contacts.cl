// SPDX-License-Identifier: MIT
// Contacts between candidate pairs by the paper's rule: the most opposing pair of boundary faces gives the
// normal, the corners of the intersection give the points (README.md here; prox.md 4).
#include "backends/portable.h"
#include "algorithms/pairs.clh"
#include "algorithms/contacts/tetrahedron.clh"

#define FEATURES                                                                                             \
    56 // 0-3 corners of a in b, 4-7 corners of b in a, 8-31 edges of a x faces of b, 32-55 the reverse
#define ID_WORDS 2
#define VALUE_REALS 8

// A pair ready for its contacts.
typedef struct {
    Solid a, b;
    real size;    // largest coordinate, relative to a's first corner
    Point normal; // out of a
    Point origin; // a corner of a's most opposing face
    real reach;   // half the height of a over that face
} Encounter;

// 0 no contacts, 1 contacts, 2 degenerate, 3 separated.
#define ENCOUNTER_NONE 0
#define ENCOUNTER_MEETS 1
#define ENCOUNTER_DEGENERATE 2
#define ENCOUNTER_SEPARATED 3

// The pair of boundary faces whose outward normals oppose most; the first in order on ties. False without
// any.
DEVICE int choose_normal(Encounter* e, uint boundary_a, uint boundary_b) {
    real best = REAL_INFINITY;
    int chosen = -1;
    for (int fa = 0; fa < 4; ++fa) {
        for (int fb = 0; fb < 4; ++fb) {
            const real facing = dot_product(e->a.normal[fa], e->b.normal[fb]);
            if ((boundary_a >> fa & 1u) != 0u && (boundary_b >> fb & 1u) != 0u && facing < best) {
                best = facing;
                chosen = fa;
            }
        }
    }
    if (chosen < 0) return 0;
    e->normal = e->a.normal[chosen];
    e->origin = face_corner(&e->a, chosen);
    e->reach = ABSOLUTE(dot_product(e->normal, minus(e->a.corner[chosen], e->origin))) / 2;
    return 1;
}

// Reads both tetrahedra relative to a's first corner, which keeps precision far from the origin.
DEVICE int meet(Encounter* e, Point* translation, GLOBAL const uint* pair, GLOBAL const uint* bodies,
                GLOBAL const real* poses, GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                GLOBAL const uchar* boundary) {
    GLOBAL const uint* a = bodies + (ulong)pair[0] * BODY_WORDS;
    GLOBAL const uint* b = bodies + (ulong)pair[1] * BODY_WORDS;
    const Point origin = corner_at(a, poses + (ulong)pair[0] * 12, tetrahedra, vertices, pair[2], 0u);
    int finite = is_finite(origin);
    e->size = 0;
    for (int i = 0; i < 4; ++i) {
        const Point pa = corner_at(a, poses + (ulong)pair[0] * 12, tetrahedra, vertices, pair[2], (uint)i);
        const Point pb = corner_at(b, poses + (ulong)pair[1] * 12, tetrahedra, vertices, pair[3], (uint)i);
        e->a.corner[i] = minus(pa, origin);
        e->b.corner[i] = minus(pb, origin);
        finite = finite && is_finite(e->a.corner[i]) && is_finite(e->b.corner[i]);
        e->size =
            larger(e->size, larger(largest_component(e->a.corner[i]), largest_component(e->b.corner[i])));
    }
    *translation = origin;
    if (!finite || !close_solid(&e->a) || !close_solid(&e->b)) return ENCOUNTER_DEGENERATE;
    if (separated(&e->a, &e->b, e->size)) return ENCOUNTER_SEPARATED;
    return choose_normal(e, boundary[a[BODY_TETRAHEDRA] + pair[2]], boundary[b[BODY_TETRAHEDRA] + pair[3]])
               ? ENCOUNTER_MEETS
               : ENCOUNTER_NONE;
}

// Whether p lies in s, its face `but` not asked (-1: all asked).
DEVICE int inside(const Solid* s, Point p, int but, real size) {
    const real margin = (32 * ROUNDOFF) * size;
    for (int f = 0; f < 4; ++f)
        if (f != but && !(face_distance(s, f, p) <= margin)) return 0;
    return 1;
}

// Where edge `edge` of `s` crosses face `face` of `t`: its ends lie strictly on different sides, so that
// corners on the plane are left to the features of corners, and the division is by more than either distance.
DEVICE int crossing(const Solid* s, int edge, const Solid* t, int face, real size, Point* at) {
    const Point p = s->corner[edge_end(edge, 0)];
    const Point q = s->corner[edge_end(edge, 1)];
    const real from = face_distance(t, face, p);
    const real to = face_distance(t, face, q);
    if (!((from > 0 && to < 0) || (from < 0 && to > 0))) return 0;
    const real part = from / (from - to);
    at->x = p.x + part * (q.x - p.x);
    at->y = p.y + part * (q.y - p.y);
    at->z = p.z + part * (q.z - p.z);
    return inside(t, *at, face, size);
}

// Whether feature `feature` is a contact; its point and depth. Points deeper than half the height are
// dropped.
DEVICE int contact_of(const Encounter* e, int feature, Point* at, real* depth) {
    int found;
    if (feature < 4) {
        *at = e->a.corner[feature];
        found = inside(&e->b, *at, -1, e->size);
    } else if (feature < 8) {
        *at = e->b.corner[feature - 4];
        found = inside(&e->a, *at, -1, e->size);
    } else if (feature < 32) {
        found = crossing(&e->a, (feature - 8) / 4, &e->b, (feature - 8) % 4, e->size, at);
    } else {
        found = crossing(&e->b, (feature - 32) / 4, &e->a, (feature - 32) % 4, e->size, at);
    }
    if (!found) return 0;
    *depth = dot_product(e->normal, minus(*at, e->origin));
    return ABSOLUTE(*depth) < e->reach;
}

DEVICE void store_contact(const Encounter* e, Point translation, Point at, real depth, GLOBAL real* values) {
    values[0] = (at.x + translation.x) + (real)0;
    values[1] = (at.y + translation.y) + (real)0;
    values[2] = (at.z + translation.z) + (real)0;
    values[3] = e->normal.x + (real)0;
    values[4] = e->normal.y + (real)0;
    values[5] = e->normal.z + (real)0;
    values[6] = depth + (real)0;
    values[7] = 0;
}

// Contacts of pairs first.. of `found`. One reservation a pair; past contact_capacity only the counter goes
// on.
KERNEL void generate_contacts(GLOBAL const uint* found, uint first, uint pair_capacity,
                              GLOBAL const uint* bodies, GLOBAL const real* poses,
                              GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                              GLOBAL const uchar* boundary, GLOBAL uint* contact_ids,
                              GLOBAL real* contact_values, uint contact_capacity, GLOBAL uint* status) {
    const uint pairs = status[STATUS_PAIRS];
    const uint count = status[STATUS_PAIRS + 1] != 0u || pairs > pair_capacity ? pair_capacity : pairs;
    for (uint i = first + GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        Encounter e;
        Point translation;
        Point at;
        real depth = 0;
        const int kind = meet(&e, &translation, found + (ulong)i * PAIR_WORDS, bodies, poses, tetrahedra,
                              vertices, boundary);
        if (kind == ENCOUNTER_DEGENERATE) counter_add(status + STATUS_DEGENERATE, 1u);
        if (kind == ENCOUNTER_SEPARATED) counter_add(status + STATUS_REJECTED, 1u);
        ulong kept = 0;
        uint contacts = 0;
        for (int feature = 0; kind == ENCOUNTER_MEETS && feature < FEATURES; ++feature) {
            if (!contact_of(&e, feature, &at, &depth)) continue;
            kept |= (ulong)1 << feature;
            ++contacts;
        }
        if (contacts == 0u) continue;
        uint slot = counter_add(status + STATUS_CONTACTS, contacts);
        for (int feature = 0; feature < FEATURES; ++feature) {
            if ((kept >> feature & (ulong)1) == 0) continue;
            if (slot < contact_capacity) {
                contact_of(&e, feature, &at, &depth);
                contact_ids[(ulong)slot * ID_WORDS] = i;
                contact_ids[(ulong)slot * ID_WORDS + 1u] = (uint)feature;
                store_contact(&e, translation, at, depth, contact_values + (ulong)slot * VALUE_REALS);
            }
            ++slot;
        }
    }
}

// The bits of a real number, as digests take them.
DEVICE ulong bits_of(real value) {
    union {
        real number;
#if PRECISION == 64
        ulong bits;
#else
        uint bits;
#endif
    } both;
    both.number = value;
    return both.bits;
}

// Digest of the contacts: every term mixes the pair, the feature and the bits of the seven values.
KERNEL void digest_contacts(GLOBAL const uint* found, GLOBAL const uint* bodies, GLOBAL const uint* ids,
                            GLOBAL const uint* contact_ids, GLOBAL const real* contact_values,
                            uint contact_capacity, GLOBAL uint* status) {
    const uint contacts = status[STATUS_CONTACTS];
    const uint count =
        status[STATUS_CONTACTS + 1] != 0u || contacts > contact_capacity ? contact_capacity : contacts;
    ulong sum_a = 0;
    ulong sum_b = 0;
    for (uint i = GLOBAL_ID; i < count; i += GLOBAL_COUNT) {
        GLOBAL const uint* pair = found + (ulong)contact_ids[(ulong)i * ID_WORDS] * PAIR_WORDS;
        ulong term = digest_a(pair[0], ids[bodies[(ulong)pair[0] * BODY_WORDS + BODY_TETRAHEDRA] + pair[2]],
                              pair[1], ids[bodies[(ulong)pair[1] * BODY_WORDS + BODY_TETRAHEDRA] + pair[3]]);
        term = mix(term + contact_ids[(ulong)i * ID_WORDS + 1u]);
        for (uint value = 0; value < 7u; ++value)
            term = mix(term + bits_of(contact_values[(ulong)i * VALUE_REALS + value]));
        sum_a += term;
        sum_b += digest_b(term);
    }
    if (sum_a != 0 || sum_b != 0) {
        counter_add_wide(status + STATUS_CONTACT_DIGEST_A, sum_a);
        counter_add_wide(status + STATUS_CONTACT_DIGEST_B, sum_b);
    }
}
