// SPDX-License-Identifier: MIT
// output=distances: of the contacts of each body pair only the one with the least distance stays. A table has
// a contact's number, plus 1, at a place that a hash of its body pair gives, or at the next free one (linear
// probing: Knuth 1998, 6.4). A contact replaces a worse one, so that the result does not depend on the order.
// Host variants: PRECISION
#include "backends/portable.h"
#include "algorithms/answer/contact_rows.clh"
#include "algorithms/answer/pairs.clh"

#define DISTANCE_REAL 6 // of the reals of a contact

// Contacts, and the pairs that they refer to.
typedef struct {
    GLOBAL const uint* found;
    GLOBAL const uint* owners;
    GLOBAL const uint* ids;
    GLOBAL const uint* contact_ids;
    GLOBAL const real* contact_values;
} Measured;

typedef struct {
    WordRow pair; // with the numbers of the scene
    real distance;
} Distance;

DEVICE Distance distance_of(const Measured* all, ulong contact) {
    const PairMembers pair = members_of(all->found, all->contact_ids[contact * CONTACT_WORDS], all->owners);
    Distance one;
    one.pair = named(&pair, all->ids);
    one.distance = all->contact_values[contact * CONTACT_REALS + DISTANCE_REAL];
    return one;
}

DEVICE int is_of_same_bodies(const Distance* p, const Distance* q) {
    return p->pair.x == q->pair.x && p->pair.z == q->pair.z;
}

// Ties go to the smaller numbers of tetrahedra, a's first.
DEVICE int is_closer(const Distance* p, const Distance* q) {
    if (p->distance != q->distance) return p->distance < q->distance;
    return p->pair.y != q->pair.y ? p->pair.y < q->pair.y : p->pair.w < q->pair.w;
}

// `table`: `places` words, a power of two and more than body pairs with contacts; 0 before.
KERNEL void find_closest(GLOBAL const uint* found, GLOBAL const uint* owners, GLOBAL const uint* ids,
                         GLOBAL const uint* contact_ids, GLOBAL const real* contact_values, uint capacity,
                         GLOBAL uint* table, uint places, GLOBAL uint* status) {
    const Measured all = {found, owners, ids, contact_ids, contact_values};
    const uint rows = rows_in(status + STATUS_CONTACTS, capacity);
    for (ulong i = GLOBAL_ID; i < rows; i += GLOBAL_COUNT) {
        const Distance one = distance_of(&all, i);
        uint place = (uint)mix((ulong)one.pair.x << 32 | one.pair.z) & (places - 1u);
        uint tried = 0;
        uint there = ATOMIC_READ(table + place);
        while (tried < places) {
            if (there != 0u) {
                const Distance other = distance_of(&all, there - 1u);
                if (!is_of_same_bodies(&one, &other)) {
                    ++tried;
                    place = (place + 1u) & (places - 1u);
                    there = ATOMIC_READ(table + place);
                    continue;
                }
                if (!is_closer(&one, &other)) break;
            }
            const uint before = ATOMIC_REPLACE(table + place, there, (uint)i + 1u);
            if (before == there) break;
            there = before;
        }
        if (tried == places) status[STATUS_EXCEEDED + EXCEEDED_CLOSEST] = 1u;
    }
}

// Copies the contacts in the table, in any order, and counts them. Copies nothing if some did not fit.
KERNEL void keep_closest(GLOBAL const uint* table, uint places, GLOBAL const uint* contact_ids,
                         GLOBAL const real* contact_values, uint capacity, GLOBAL uint* kept_ids,
                         GLOBAL real* kept_values, GLOBAL uint* status) {
    if (status[STATUS_CONTACTS + 1] != 0u || status[STATUS_CONTACTS] > capacity) return;
    for (ulong place = GLOBAL_ID; place < places; place += GLOBAL_COUNT) {
        const uint contact = table[place];
        if (contact == 0u) continue;
        const ulong row = counter_add(status + STATUS_CLOSEST, 1u);
        ((GLOBAL WordPair*)kept_ids)[row] = ((GLOBAL const WordPair*)contact_ids)[contact - 1u];
        GLOBAL const RealRow* from = (GLOBAL const RealRow*)contact_values + 2 * (ulong)(contact - 1u);
        GLOBAL RealRow* to = (GLOBAL RealRow*)kept_values + 2 * row;
        to[0] = from[0];
        to[1] = from[1];
    }
}

// Those are the contacts of the frame. One work-item does it.
KERNEL void count_closest(uint capacity, GLOBAL uint* status) {
    if (GLOBAL_ID != 0u || status[STATUS_CONTACTS + 1] != 0u || status[STATUS_CONTACTS] > capacity) return;
    status[STATUS_CONTACTS] = status[STATUS_CLOSEST];
}
