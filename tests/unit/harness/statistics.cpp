// SPDX-License-Identifier: MIT
#include "base/statistics.h"
#include "tests/support/test.h"

#include <random>

namespace tandem {
namespace {

TEST(Statistics, MediansAreMiddleValues) {
    EXPECT_EQ(median({5}), 5);
    EXPECT_EQ(median({9, 1, 4}), 4);
    EXPECT_EQ(median(std::vector<std::int64_t>{9, 1, 4, 5}), 4.5);
}

TEST(Statistics, QuartilesInterpolate) {
    const std::vector<std::int64_t> samples{40, 10, 30, 20};
    const auto s = summarise(samples);
    EXPECT_DOUBLE_EQ(s.median, 25);
    EXPECT_DOUBLE_EQ(s.q1, 17.5);
    EXPECT_DOUBLE_EQ(s.q3, 32.5);
}

TEST(Statistics, IntervalContainsTheMedianAndIsReproducible) {
    std::vector<std::int64_t> samples;
    for (int i = 0; i < 50; ++i) samples.push_back((i * 37) % 101);
    const auto s = summarise(samples);
    EXPECT_LE(s.low, s.median);
    EXPECT_GE(s.high, s.median);
    EXPECT_LT(s.low, s.high);
    EXPECT_EQ(summarise(samples).low, s.low);
}

// Values of SciPy: norm.cdf(-sqrt(n / (n - 1)) * t.ppf(0.975, n - 1)).
TEST(Statistics, IntervalsOfFewValuesExcludeLess) {
    EXPECT_EQ(interval_tail(1), 0);
    EXPECT_NEAR(interval_tail(2), 0, 1e-30);
    EXPECT_NEAR(interval_tail(3), 6.834137304562962e-08, 1e-14);
    EXPECT_NEAR(interval_tail(5), 0.0009541005518824723, 1e-9);
    EXPECT_NEAR(interval_tail(10), 0.008550639025807874, 1e-9);
    EXPECT_NEAR(interval_tail(18), 0.01496625446574617, 1e-9);
    EXPECT_NEAR(interval_tail(1001), 0.02480450117520623, 1e-9);
}

TEST(Statistics, OneSample) {
    const std::vector<std::int64_t> samples{7};
    const auto s = summarise(samples);
    EXPECT_EQ(s.median, 7);
    EXPECT_EQ(s.low, 7);
    EXPECT_EQ(s.high, 7);
}

TEST(Statistics, SpreadUsesTheNinetyNinthPercentile) {
    std::vector<double> samples;
    for (int i = 200; i > 0; --i) samples.push_back(i);
    const auto s = spread(samples);
    ASSERT_TRUE(s);
    EXPECT_EQ(s->median, 100);
    EXPECT_EQ(s->p99, 198);
    EXPECT_EQ(s->maximum, 200);
    EXPECT_FALSE(spread({}));
}

TEST(Statistics, RoundsAreTheIndependentValues) {
    // Three rounds of almost equal samples: as many independent values as rounds.
    const std::vector<std::int64_t> samples{100, 101, 102, 200, 201, 202, 300, 301, 302};
    const std::vector<std::uint32_t> rounds{0, 0, 0, 1, 1, 1, 2, 2, 2};
    EXPECT_EQ(round_medians(samples, rounds), (std::vector<double>{101, 201, 301}));
    const auto by_round = summarise(samples, rounds);
    EXPECT_EQ(by_round.median, 201);
    EXPECT_EQ(by_round.low, 101);
    EXPECT_EQ(by_round.high, 301);
    // One sample a round is the same as samples without rounds.
    const std::vector<std::uint32_t> apart{0, 1, 2, 3, 4, 5, 6, 7, 8};
    EXPECT_EQ(summarise(samples, apart).low, summarise(samples).low);
    EXPECT_EQ(summarise(samples, apart).median, summarise(samples).median);
}

TEST(Statistics, OutliersAreFarFromTheMedianRelativeToTheScatter) {
    EXPECT_EQ(count_outliers({}), 0u);
    EXPECT_EQ(count_outliers(std::vector<double>{1, 2, 3, 4, 5, 6, 700}), 0u);  // seven are too few
    EXPECT_EQ(count_outliers(std::vector<double>{5, 5, 5, 5, 5, 5, 5, 9}), 0u); // no scatter to compare with
    // Deviations have median 2: 1.4826 * 2 * 5 = 14.8.
    EXPECT_EQ(count_outliers(std::vector<double>{96, 97, 98, 99, 100, 101, 102, 103, 104}), 0u);
    EXPECT_EQ(count_outliers(std::vector<double>{97, 98, 98, 99, 100, 101, 102, 103, 114}), 0u);
    EXPECT_EQ(count_outliers(std::vector<double>{97, 98, 98, 99, 100, 101, 102, 60, 140}), 2u);
}

TEST(Statistics, DriftIsMonotonic) {
    std::vector<double> rising, swinging;
    for (int i = 0; i < 20; ++i) {
        rising.push_back(100 + i);
        swinging.push_back(i % 2 == 0 ? 100 : 120);
    }
    EXPECT_FALSE(drift(std::vector<double>{1, 2, 3, 4, 5, 6, 7})); // seven are too few
    EXPECT_FALSE(drift(swinging));
    ASSERT_TRUE(drift(rising));
    EXPECT_DOUBLE_EQ(*drift(rising), 19 / 109.5);
    std::reverse(rising.begin(), rising.end());
    EXPECT_DOUBLE_EQ(drift(rising).value_or(0), -19 / 109.5);
}

/// Drift is reported for at most 1 % of series without drift: 2,000 series, three standard deviations of the
/// binomial.
TEST(Statistics, DriftIsRarelyReportedWithoutDrift) {
    std::mt19937_64 random(3);
    int seen = 0;
    for (int i = 0; i < 2000; ++i) {
        std::vector<double> values(12);
        for (auto& value : values) value = static_cast<double>(random() % 100000);
        seen += drift(values) ? 1 : 0;
    }
    EXPECT_LE(seen, 20 + 3 * 4.5);
    EXPECT_GT(seen, 0);
}

} // namespace
} // namespace tandem
