// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace tandem {

/// Calls work(i) for i < count on all cores. `work` must not throw.
template<class Work>
void parallel_for(std::size_t count, Work work) {
    std::atomic<std::size_t> next = 0;
    const auto drain = [&] {
        for (auto i = next++; i < count; i = next++) work(i);
    };
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) others.emplace_back(drain);
    drain();
}

} // namespace tandem
