// SPDX-License-Identifier: MIT
#include "base/parallel.h"

#include "base/random.h"

#include <gtest/gtest.h>
#include <numeric>

namespace tandem {
namespace {

TEST(Parallel, EveryIndexIsWorkedOnOnce) {
    std::vector<int> times(10007);
    parallel_for(times.size(), [&](std::size_t i) { ++times[i]; });
    EXPECT_EQ(std::count(times.begin(), times.end(), 1), std::ssize(times));
}

TEST(Parallel, ThrowsWhatACallThrew) {
    std::atomic<int> begun = 0;
    EXPECT_THROW(parallel_for(1 << 20,
                              [&](std::size_t i) {
                                  ++begun;
                                  if (i == 100) throw std::bad_alloc();
                              }),
                 std::bad_alloc);
    EXPECT_GT(begun, 100);
    EXPECT_LT(begun, 1 << 20);
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
