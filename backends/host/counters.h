// SPDX-License-Identifier: MIT
// Words that work-items of the host device share; a part of dialect.h.
#pragma once

#include <utility>

using uint = unsigned int;

namespace tandem::host {

/// The work-group that a thread runs, and whether other threads run groups of the same launch.
inline constinit thread_local uint group_id = 0;
inline constinit thread_local uint group_count = 1;
inline constinit thread_local bool in_parallel = false;

/// Adds to memory that all work-groups share.
[[gnu::always_inline]] inline uint fetch_add(uint* pointer, uint value) {
    if (in_parallel) return __atomic_fetch_add(pointer, value, __ATOMIC_RELAXED);
    return std::exchange(*pointer, *pointer + value);
}

/// Replaces a word that has the expected value; returns the value before.
[[gnu::always_inline]] inline uint replace(uint* pointer, uint expected, uint value) {
    __atomic_compare_exchange_n(pointer, &expected, value, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
    return expected;
}

/// Adds to a work-group's own memory.
[[gnu::always_inline]] inline uint fetch_add_locally(uint* pointer, uint value) {
    return std::exchange(*pointer, *pointer + value);
}

} // namespace tandem::host
