// SPDX-License-Identifier: MIT
#include "scenes/parallel.h"

#include "scenes/random.h"

#include <gtest/gtest.h>
#include <numeric>

namespace tandem {
namespace {

TEST(Parallel, EveryIndexIsWorkedOnOnce) {
    std::vector<int> times(10007);
    parallel_for(times.size(), [&](std::size_t i) { ++times[i]; });
    EXPECT_EQ(std::count(times.begin(), times.end(), 1), std::ssize(times));
}

TEST(Parallel, SortsListsOfAnyLength) {
    Random random(3);
    for (const std::size_t count : {0, 1, 2, 16383, 16384, 32769, 100003, 300007}) {
        std::vector<std::uint64_t> expected(count);
        std::iota(expected.begin(), expected.end(), 0);
        auto values = expected;
        for (std::size_t i = count; i > 1; --i) std::swap(values[i - 1], values[random.next() % i]);
        parallel_sort(values);
        EXPECT_EQ(values, expected) << count;
    }
}

} // namespace
} // namespace tandem
