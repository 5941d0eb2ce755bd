// SPDX-License-Identifier: MIT
// Benchmarks of a device's limits, for comparison with the times of walks: memory throughput, and overlap
// tests of nodes in registers.
// Host variants: AXES K PRECISION PRESSURE_SLAB, in lanes; of higher levels: PRECISION=32
#define IN_PACKS
#include "backends/portable.h"
#include "algorithms/hierarchy/node.clh"

// Neighbouring work-items read neighbouring words, and each issues IN_FLIGHT reads at once to hide their
// latency. A work-item that has no neighbours reads pages.
#if GROUP_SIZE == 1
#define IN_FLIGHT 512
#define FIRST_WORD ((ulong)GLOBAL_ID * IN_FLIGHT)
#define APART 1u
#define ADDED(sum, word, round) ((sum) + ((word) ^ (round))) // in vectors
#else
#define IN_FLIGHT 8
#define FIRST_WORD GLOBAL_ID
#define APART ((ulong)GLOBAL_COUNT)
#define ADDED(sum, word, round) ((sum)*3u + (word) + (round))
#endif

// `words`: a multiple of the number of work-items times IN_FLIGHT.
KERNEL void copy_words(GLOBAL const ulong* from, GLOBAL ulong* to, ulong words) {
    for (ulong i = FIRST_WORD; i < words; i += (ulong)GLOBAL_COUNT * IN_FLIGHT) {
        ulong held[IN_FLIGHT];
        for (int j = 0; j < IN_FLIGHT; ++j) held[j] = from[i + (ulong)j * APART];
        for (int j = 0; j < IN_FLIGHT; ++j) to[i + (ulong)j * APART] = held[j];
    }
}

// Reads `words` words `rounds` times. The sum has a use so that the reads are not optimised away, but it is
// never written: no upload gives this value.
KERNEL void read_words(GLOBAL const ulong* from, GLOBAL ulong* out, ulong words, uint rounds) {
    ulong sum = 0;
    for (uint round = 0; round < rounds; ++round) {
        for (ulong i = FIRST_WORD; i < words; i += (ulong)GLOBAL_COUNT * IN_FLIGHT) {
            ulong held[IN_FLIGHT];
            for (int j = 0; j < IN_FLIGHT; ++j) held[j] = from[i + (ulong)j * APART];
            for (int j = 0; j < IN_FLIGHT; ++j) sum = ADDED(sum, held[j], round);
        }
    }
    if (sum == 0x123456789abcdefUL) out[0] = sum;
}

KERNEL void do_nothing(GLOBAL uint* out) {
    if (GLOBAL_ID == 0xffffffffu) out[0] = 1u;
}

// Each work-item does rounds * DIRECTIONS closed overlap tests of K comparisons in each element of a pack;
// `elements` gets their number. Slabs of b rotate in each turn and grow after each round, so that the
// compiler cannot reuse a result.
KERNEL void test_overlaps(GLOBAL const real* nodes, GLOBAL uint* counts, GLOBAL uint* elements, uint rounds,
                          uint turns) {
    reals a[K];
    reals b[K];
    for (int i = 0; i < K; ++i) a[i] = SAME(nodes[i]);
    for (int i = 0; i < K; ++i) b[i] = SAME(nodes[K + i] + (real)(GLOBAL_ID & 7u));
    uints found = SAME_WORD(0);
    for (uint round = 0; round < rounds; ++round) {
        UNROLL for (int turn = 0; turn < DIRECTIONS; ++turn) {
            flags apart = NEVER;
            UNROLL for (int axis = 0; axis < DIRECTIONS; ++axis) {
                const int other = (axis + turn) % DIRECTIONS;
                apart |= (a[axis] > b[other + DIRECTIONS]) | (b[other] > a[axis + DIRECTIONS]);
            }
            found += BIT(NOT(apart));
        }
        for (int i = 0; i < K; ++i) b[i] = b[i] + (real)turns;
    }
    uint sum = 0u;
    FOR_PACK(i) sum += AT(found, i);
    counts[GLOBAL_ID] = sum;
    if (GLOBAL_ID == 0u) elements[0] = PACK;
}
