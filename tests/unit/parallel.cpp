// SPDX-License-Identifier: MIT
#include "base/parallel.h"

#include "base/random.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <gtest/gtest.h>
#include <mutex>
#include <numeric>
#include <set>
#include <thread>

namespace tandem {
namespace {

TEST(Parallel, EveryIndexIsProcessedOnce) {
    std::vector<int> times(10007);
    parallel_for(times.size(), [&](std::size_t i) { ++times[i]; });
    EXPECT_EQ(std::count(times.begin(), times.end(), 1), std::ssize(times));
}

TEST(Parallel, RethrowsAnException) {
    std::atomic<int> begun = 0;
    EXPECT_THROW(parallel_for(1 << 20,
                              [&](std::size_t i) {
                                  ++begun;
                                  if (i == 100) throw std::bad_alloc();
                              }),
                 std::bad_alloc);
    EXPECT_GT(begun, 0);
    EXPECT_LT(begun, 1 << 20);
}

TEST(Parallel, BlockingCallsRunAtOnceAlsoBeyondTheCores) {
    const auto threads = usable_cores() + 2;
    std::mutex mutex;
    std::condition_variable all_arrived;
    std::size_t arrived = 0;
    parallel_for(threads, threads, [&](std::size_t) {
        std::unique_lock lock(mutex);
        if (++arrived == threads) all_arrived.notify_all();
        EXPECT_TRUE(all_arrived.wait_for(lock, std::chrono::minutes(2), [&] { return arrived == threads; }));
    });
}

TEST(Parallel, LoopsReuseTheThreadsOfThePool) {
    std::mutex mutex;
    std::set<std::thread::id> ids;
    for (int i = 0; i < 200; ++i)
        parallel_for(usable_cores(), [&](std::size_t) {
            const std::lock_guard lock(mutex);
            ids.insert(std::this_thread::get_id());
        });
    EXPECT_LE(ids.size(), usable_cores() + 2) << "the pool, grown by the test above at most";
}

TEST(Parallel, SortsListsOfAnyLengthInAnyNumberOfParts) {
    Random random(3);
    for (const std::size_t count : {0, 1, 2, 5, 100, 4099}) {
        std::vector<std::uint64_t> expected(count);
        std::iota(expected.begin(), expected.end(), 0);
        auto shuffled = expected;
        for (std::size_t i = count; i > 1; --i) std::swap(shuffled[i - 1], shuffled[random.next() % i]);
        for (std::size_t parts = 1; parts < 20; ++parts) {
            auto values = shuffled;
            parallel_sort(values, parts);
            EXPECT_EQ(values, expected) << count << " in " << parts;
        }
        auto values = shuffled;
        parallel_sort(values);
        EXPECT_EQ(values, expected);
    }
}

} // namespace
} // namespace tandem
