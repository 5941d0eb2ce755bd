// SPDX-License-Identifier: MIT
// Benchmarks of a device's limits, for comparison with the times of walks: memory throughput, and overlap
// tests of nodes in registers.
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/hierarchy/node.clh"

// Neighbouring work-items read neighbouring words. Each issues IN_FLIGHT reads at once to hide their latency.
#define IN_FLIGHT 8

// `words`: a multiple of the number of work-items times IN_FLIGHT.
KERNEL void copy_words(GLOBAL const ulong* from, GLOBAL ulong* to, ulong words) {
    const ulong stride = GLOBAL_COUNT;
    for (ulong i = GLOBAL_ID; i < words; i += stride * IN_FLIGHT) {
        ulong held[IN_FLIGHT];
        for (int j = 0; j < IN_FLIGHT; ++j) held[j] = from[i + (ulong)j * stride];
        for (int j = 0; j < IN_FLIGHT; ++j) to[i + (ulong)j * stride] = held[j];
    }
}

// Reads `words` words `rounds` times. The sum has a use so that the reads are not optimised away, but it is
// never written: no upload gives this value.
KERNEL void read_words(GLOBAL const ulong* from, GLOBAL ulong* out, ulong words, uint rounds) {
    const ulong stride = GLOBAL_COUNT;
    ulong sum = 0;
    for (uint round = 0; round < rounds; ++round) {
        for (ulong i = GLOBAL_ID; i < words; i += stride * IN_FLIGHT) {
            ulong held[IN_FLIGHT];
            for (int j = 0; j < IN_FLIGHT; ++j) held[j] = from[i + (ulong)j * stride];
            for (int j = 0; j < IN_FLIGHT; ++j) sum = sum * 3u + held[j] + round;
        }
    }
    if (sum == 0x123456789abcdefUL) out[0] = sum;
}

KERNEL void do_nothing(GLOBAL uint* out) {
    if (GLOBAL_ID == 0xffffffffu) out[0] = 1u;
}

// Each work-item does rounds * DIRECTIONS closed overlap tests of K comparisons. Slabs of b rotate in each
// turn and grow after each round, so that the compiler cannot reuse a result.
KERNEL void test_overlaps(GLOBAL const real* nodes, GLOBAL uint* counts, uint rounds, uint turns) {
    real a[K];
    real b[K];
    for (int i = 0; i < K; ++i) a[i] = nodes[i];
    for (int i = 0; i < K; ++i) b[i] = nodes[K + i] + (real)(GLOBAL_ID & 7u);
    uint found = 0u;
    for (uint round = 0; round < rounds; ++round) {
        UNROLL for (int turn = 0; turn < DIRECTIONS; ++turn) {
            int apart = 0;
            UNROLL for (int axis = 0; axis < DIRECTIONS; ++axis) {
                const int other = (axis + turn) % DIRECTIONS;
                apart |= (a[axis] > b[other + DIRECTIONS]) | (b[other] > a[axis + DIRECTIONS]);
            }
            found += apart == 0 ? 1u : 0u;
        }
        for (int i = 0; i < K; ++i) b[i] = b[i] + (real)turns;
    }
    counts[GLOBAL_ID] = found;
}
