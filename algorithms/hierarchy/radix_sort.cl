// SPDX-License-Identifier: MIT
// Stable radix sort of keys with values, RADIX_BITS bits a pass, from the lowest digit up. A pass has two
// launches with the same grid. Each work-group counts the digits of its part of the rows, then moves these
// rows in order. No group waits for another.
// Host variants: PRECISION
#include "backends/portable.h"
#include "algorithms/kernels/parts.clh"

#define RADIX_BITS 8
#define DIGITS (1u << RADIX_BITS)

DEVICE uint digit_of(uint key, uint shift) { return key >> shift & (DIGITS - 1u); }

// The rows to sort: none where the flag is 0.
DEVICE uint rows_to_sort(GLOBAL const uint* flag, uint count) { return flag[0] != 0u ? count : 0u; }

// counts[group * DIGITS + digit] = rows of the group's part with that digit.
KERNEL void count_digits(GLOBAL const uint* keys, uint count, uint shift, GLOBAL const uint* flag,
                         GLOBAL uint* counts) {
    LOCAL_ARRAY(uint, own, DIGITS);
    const uint rows = rows_to_sort(flag, count);
    const uint end = group_first(GROUP_ID + 1u, rows);
    for (uint digit = LOCAL_ID; digit < DIGITS; digit += (uint)GROUP_SIZE) own[digit] = 0u;
    BARRIER;
    for (uint i = group_first(GROUP_ID, rows) + LOCAL_ID; i < end; i += (uint)GROUP_SIZE)
        LOCAL_ATOMIC_ADD(own + digit_of(keys[i], shift), 1u);
    BARRIER;
    if (rows == 0u) return;
    for (uint digit = LOCAL_ID; digit < DIGITS; digit += (uint)GROUP_SIZE)
        counts[GROUP_ID * DIGITS + digit] = own[digit];
}

// starts[digit] = rows with the digit in earlier groups, totals[digit] = those in all groups.
DEVICE void sum_digits(GLOBAL const uint* counts, LOCAL uint* starts, LOCAL uint* totals) {
    for (uint digit = LOCAL_ID; digit < DIGITS; digit += (uint)GROUP_SIZE) {
        uint before = 0;
        uint all = 0;
        for (uint group = 0; group < GROUP_COUNT; ++group) {
            const uint one = counts[group * DIGITS + digit];
            if (group < GROUP_ID) before += one;
            all += one;
        }
        starts[digit] = before;
        totals[digit] = all;
    }
}

// Moves the group's rows to their places by this digit. A work-item has one row a turn. Its place is the
// number of rows before it with its digit, which are counted in local memory.
KERNEL void scatter_digits(GLOBAL const uint* keys, GLOBAL const uint* values, uint count, uint shift,
                           GLOBAL const uint* flag, GLOBAL const uint* counts, GLOBAL uint* sorted_keys,
                           GLOBAL uint* sorted_values) {
    LOCAL_ARRAY(uint, starts, DIGITS);
    LOCAL_ARRAY(uint, totals, DIGITS);
    LOCAL_ARRAY(uint, digits, GROUP_SIZE);
    const uint rows = rows_to_sort(flag, count);
    const uint end = group_first(GROUP_ID + 1u, rows);
    uint first = group_first(GROUP_ID, rows);
    if (rows != 0u) sum_digits(counts, starts, totals);
    BARRIER;
    if (LOCAL_ID == 0u) {
        uint sum = 0;
        for (uint digit = 0; digit < DIGITS; ++digit) {
            starts[digit] += sum;
            sum += totals[digit];
        }
    }
    BARRIER;
    do { // runs at least once, as loops with barriers must
        const uint i = first + LOCAL_ID;
        const uint key = i < end ? keys[i] : 0u;
        const uint digit = i < end ? digit_of(key, shift) : DIGITS;
        digits[LOCAL_ID] = digit;
        BARRIER;
        uint before = 0;
        uint after = 0;
        for (uint other = 0; other < LOCAL_ID; ++other) before += digits[other] == digit ? 1u : 0u;
        for (uint other = LOCAL_ID + 1u; other < (uint)GROUP_SIZE; ++other)
            after += digits[other] == digit ? 1u : 0u;
        if (i < end) {
            sorted_keys[starts[digit] + before] = key;
            sorted_values[starts[digit] + before] = values[i];
        }
        BARRIER;
        if (i < end && after == 0u) starts[digit] += before + 1u;
        BARRIER;
        first += (uint)GROUP_SIZE;
    } while (first < end);
}
