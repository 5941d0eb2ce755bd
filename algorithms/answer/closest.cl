// SPDX-License-Identifier: MIT
// output=distances: of the contacts of each body pair only the one with the least distance stays.
// Host variants: PRECISION
#define RANK_REAL 6 // the distance
#include "backends/portable.h"
#include "algorithms/answer/body_pair_table.clh"

KERNEL void find_closest(GLOBAL const uint* found, GLOBAL const uint* owners, GLOBAL const uint* ids,
                         GLOBAL const uint* contact_ids, GLOBAL const real* contact_values, uint capacity,
                         GLOBAL uint* table, uint places, GLOBAL uint* status) {
    LOCAL_ARRAY(GroupContact, best, GROUP_SIZE);
    const ContactTable all = {found, owners, ids, contact_ids, contact_values};
    const ulong rows = rows_in(status + STATUS_CONTACTS, capacity);
    ulong first = GROUP_ID * (ulong)GROUP_SIZE;
    do { // at least once, as loops with barriers must: see refit.cl
        const uint count = first < rows ? of_group(rows - first) : 0u;
        const uint place = place_in_group(&all, first, count, table, places, best);
        if (LOCAL_ID < count && place == places) status[STATUS_EXCEEDED + EXCEEDED_TABLE] = 1u;
        BARRIER; // the next contacts replace these
        first += GLOBAL_COUNT;
    } while (first < rows);
}

// Copies the contacts in the table, in any order, and counts them. Copies nothing if some did not fit.
KERNEL void keep_closest(GLOBAL const uint* table, uint places, GLOBAL const uint* contact_ids,
                         GLOBAL const real* contact_values, uint capacity, GLOBAL uint* kept_ids,
                         GLOBAL real* kept_values, GLOBAL uint* status) {
    if (!contacts_fit(status, capacity)) return;
    for (ulong place = GLOBAL_ID; place < places; place += GLOBAL_COUNT) {
        const uint contact = table[place];
        if (contact == 0u) continue;
        const ulong row = counter_add(status + STATUS_REDUCED, 1u);
        ((GLOBAL WordPair*)kept_ids)[row] = ((GLOBAL const WordPair*)contact_ids)[contact - 1u];
        GLOBAL const RealRow* from = (GLOBAL const RealRow*)contact_values + 2 * (ulong)(contact - 1u);
        GLOBAL RealRow* to = (GLOBAL RealRow*)kept_values + 2 * row;
        to[0] = from[0];
        to[1] = from[1];
    }
}

// Those are the contacts of the frame. One work-item does it.
KERNEL void count_reduced(uint capacity, GLOBAL uint* status) {
    if (GLOBAL_ID != 0u || !contacts_fit(status, capacity)) return;
    status[STATUS_CONTACTS] = status[STATUS_REDUCED];
}
