// SPDX-License-Identifier: MIT
#include "base/parallel.h"

#include "base/random.h"
#include "tests/support/test.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <unistd.h>

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

/// Runs a loop in which each call waits for all others, so that each needs a thread of its own. Returns the
/// kernel's ids of the threads, as those of std::thread are used again.
std::set<pid_t> threads_of_a_loop(std::size_t count) {
    std::mutex mutex;
    std::condition_variable all_arrived;
    std::set<pid_t> ids;
    parallel_for(count, count, [&](std::size_t) {
        std::unique_lock lock(mutex);
        ids.insert(gettid());
        if (ids.size() == count) all_arrived.notify_all();
        EXPECT_TRUE(all_arrived.wait_for(lock, std::chrono::minutes(2), [&] { return ids.size() == count; }));
    });
    return ids;
}

TEST(Parallel, BlockingCallsRunAtOnceAlsoBeyondTheCores) {
    const auto threads = usable_cores() + 2;
    EXPECT_EQ(threads_of_a_loop(threads).size(), threads);
}

TEST(Parallel, LoopsReuseTheThreadsOfThePool) {
    std::set<pid_t> ids;
    for (int i = 0; i < 100; ++i) ids.merge(threads_of_a_loop(2));
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
