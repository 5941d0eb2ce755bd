// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace tandem {

/// Cores that this process may use, at least 1.
std::size_t usable_cores();

/// Calls work(i) once for each i < count, in any order, on at most `threads` threads of oneTBB's pool, of
/// which the caller is one. When a call throws, no further call starts, and the first exception is thrown
/// after the running calls have ended. Calls may block: with more threads than cores the pool grows for this
/// loop.
void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& work);

/// The same on all usable cores.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work);

/// Spans of `values` in order, none empty, small enough that all cores get some of a long list.
template<class Value>
std::vector<std::span<const Value>> in_parts(std::span<const Value> values) {
    constexpr std::size_t part = 1 << 16;
    std::vector<std::span<const Value>> parts;
    for (std::size_t first = 0; first < values.size(); first += part)
        parts.push_back(values.subspan(first, std::min(part, values.size() - first)));
    return parts;
}

/// How many parts are worth sorting at once.
inline std::size_t sort_parts(std::size_t count) {
    constexpr std::size_t least = 1 << 14;
    return std::clamp<std::size_t>(count / least, 1, usable_cores());
}

/// std::sort on all cores: parts of their own, then merged by twos. No two values may be equal, or their
/// order would depend on the number of parts.
template<class Value>
void parallel_sort(std::vector<Value>& values, std::size_t parts) {
    const auto start = [&](std::size_t part) {
        return values.begin() + static_cast<std::ptrdiff_t>(std::min(part, parts) * values.size() / parts);
    };
    parallel_for(parts, [&](std::size_t i) { std::sort(start(i), start(i + 1)); });
    for (std::size_t width = 1; width < parts; width *= 2)
        parallel_for((parts + 2 * width - 1) / (2 * width), [&](std::size_t i) {
            const auto first = 2 * width * i;
            std::inplace_merge(start(first), start(first + width), start(first + 2 * width));
        });
}

template<class Value>
void parallel_sort(std::vector<Value>& values) {
    parallel_sort(values, sort_parts(values.size()));
}

} // namespace tandem
