// SPDX-License-Identifier: MIT
// Contacts between candidate pairs: 2 words (pair, feature) and 8 reals (point, normal, depth, 0) each.
// README.md describes the rules.
#include "backends/portable.h"

#include "algorithms/narrow_phase/trial.clh"
#include "algorithms/narrow_phase/waiting.clh"

// 1: generate_contacts decides pairs and makes their contacts in one launch, as the paper's release does. 0:
// it is the last of three kernels and makes contacts of the pairs that the first two found to meet.
#ifndef AT_ONCE
#define AT_ONCE 0
#endif

// State of a pair after certificate and tests.
DEVICE int try_pair(const Candidates* all, uint index) {
    int edge = -1;
    const int state = try_certificate(all, index, &edge);
    return state == OPEN ? try_all(all, index, edge) : state;
}

// Words of a group's local memory. IN_STORAGE, BESIDE: numbers of contacts in the storage and outside it, 0
// between steps. ROWS: number of rows to write from the storage. FIRST_ROW: the first of them in the answer.
#define IN_STORAGE 0
#define BESIDE 1
#define ROWS 2
#define FIRST_ROW 3

// Reserves consecutive rows for the contacts of a group and writes them. The whole group must call it.
DEVICE void write_together(const ContactBatch* batch, uint index, const BatchStorage* storage,
                           LOCAL uint* group, const Sink* sink) {
    const uint staged = batch->count != 0u ? staged_of(batch) : 0u;
    const uint unstored = batch->count - staged;
    const uint before = staged != 0u ? LOCAL_ATOMIC_ADD(group + IN_STORAGE, staged) : 0u;
    const uint before_unstored = unstored != 0u ? LOCAL_ATOMIC_ADD(group + BESIDE, unstored) : 0u;
    for (uint i = 0; i < staged; ++i)
        storage->in_order[before + i] = (unsigned short)(i * GROUP_SIZE + LOCAL_ID);
    BARRIER;
    if (LOCAL_ID == 0u) {
        const uint count = group[IN_STORAGE] + group[BESIDE];
        group[ROWS] = group[IN_STORAGE];
        group[FIRST_ROW] = count != 0u ? counter_add(sink->status + STATUS_CONTACTS, count) : 0u;
        group[IN_STORAGE] = group[BESIDE] = 0u;
    }
    BARRIER;
    const uint rows = group[ROWS];
    const ulong slot = group[FIRST_ROW];
    write_staged(storage, rows, slot, sink);
    if (unstored != 0u) write_unstored(batch, staged, index, slot + rows + before_unstored, sink);
    BARRIER;
}

// `meeting`: read unless AT_ONCE. `first`, `pair_capacity` and `verdicts`: as in certify_pairs, if AT_ONCE.
KERNEL void generate_contacts(GLOBAL const uint* found, uint first, uint pair_capacity,
                              GLOBAL const uint* owners, GLOBAL const real* poses,
                              GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                              GLOBAL const uchar* boundary, GLOBAL const uchar* verdicts,
                              GLOBAL const uint* meeting, GLOBAL uint* contact_ids,
                              GLOBAL real* contact_values, uint contact_capacity, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, group, GROUP_WORDS);
    LOCAL_ARRAY(RealRow, touches, STAGED * GROUP_SIZE);
    LOCAL_ARRAY(RealRow, origins, GROUP_SIZE);
    LOCAL_ARRAY(RealRow, normals, GROUP_SIZE);
    LOCAL_ARRAY(uint, pairs, GROUP_SIZE);
    LOCAL_ARRAY(unsigned short, in_order, STAGED* GROUP_SIZE);
    LOCAL_ARRAY(uchar, features, STAGED * GROUP_SIZE);
    const BatchStorage storage = {touches, features, origins, normals, pairs, in_order};
    const Candidates all = {found, owners, poses, tetrahedra, vertices, boundary};
    const Sink sink = {contact_ids, contact_values, status, contact_capacity};
    const ulong count =
        AT_ONCE ? stored(status + STATUS_PAIRS, pair_capacity) : status[STATUS_WAITING + LIST_MEETING];
    ulong start = (AT_ONCE ? (ulong)first : 0u) + GROUP_ID * (uint)GROUP_SIZE;
    begin_group(group);
    do {
        uint index = 0;
        int state = STEPPED;
        if (start + LOCAL_ID < count) {
            index = AT_ONCE ? (uint)(start + LOCAL_ID) : meeting[start + LOCAL_ID];
            state = MEETING;
            if (AT_ONCE) {
                const int apart = DECIDED && verdicts[index] == VERDICT_APART;
                state = apart ? REJECTED : try_pair(&all, index);
                count_state(state, group);
                if (state == MEETING && has_no_normal(&all, index)) state = STEPPED;
            }
        }
        ContactBatch batch;
        batch.count = 0u;
        if (state == MEETING) batch_contacts(&all, index, &batch, &storage);
        write_together(&batch, index, &storage, group, &sink);
        start += GLOBAL_COUNT;
    } while (start < count);
    if (AT_ONCE) end_group(group, status);
}
