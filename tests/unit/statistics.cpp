// SPDX-License-Identifier: MIT
#include "harness/statistics.h"

#include <gtest/gtest.h>
#include <vector>

namespace tandem {
namespace {

TEST(Statistics, QuartilesInterpolate) {
    const std::vector<std::int64_t> samples{40, 10, 30, 20};
    const auto s = summarise(samples);
    EXPECT_DOUBLE_EQ(s.median, 25);
    EXPECT_DOUBLE_EQ(s.q1, 17.5);
    EXPECT_DOUBLE_EQ(s.q3, 32.5);
}

TEST(Statistics, IntervalHoldsTheMedianAndRepeats) {
    std::vector<std::int64_t> samples;
    for (int i = 0; i < 50; ++i) samples.push_back((i * 37) % 101);
    const auto s = summarise(samples);
    EXPECT_LE(s.low, s.median);
    EXPECT_GE(s.high, s.median);
    EXPECT_LT(s.low, s.high);
    EXPECT_EQ(summarise(samples).low, s.low);
}

TEST(Statistics, OneSample) {
    const std::vector<std::int64_t> samples{7};
    const auto s = summarise(samples);
    EXPECT_EQ(s.median, 7);
    EXPECT_EQ(s.low, 7);
    EXPECT_EQ(s.high, 7);
}

TEST(Statistics, SpreadTakesTheLeastValueThatNinetyNinePercentDoNotExceed) {
    std::vector<double> samples;
    for (int i = 200; i > 0; --i) samples.push_back(i);
    const auto s = spread(samples);
    ASSERT_TRUE(s);
    EXPECT_EQ(s->median, 100);
    EXPECT_EQ(s->p99, 198);
    EXPECT_EQ(s->maximum, 200);
    EXPECT_FALSE(spread({}));
}

} // namespace
} // namespace tandem
