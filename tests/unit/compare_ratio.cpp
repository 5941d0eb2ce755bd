// SPDX-License-Identifier: MIT
#include "harness/compare/ratio.h"
#include "harness/statistics.h"
#include "tests/unit/compare_noise.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tandem::compare {
namespace {

TEST(CompareRatio, ByHand) {
    const std::vector<double> logs{std::log(1.1), std::log(1.2), std::log(1.4)};
    EXPECT_DOUBLE_EQ(paired_ratio(logs).value, 1.2);
    const auto unpaired = unpaired_ratio(std::vector<double>{1, 2, 5}, std::vector<double>{3, 3, 4, 9});
    EXPECT_DOUBLE_EQ(unpaired.value, 3.5 / 2);
    EXPECT_LE(unpaired.low, unpaired.value);
    EXPECT_GE(unpaired.high, unpaired.value);
    EXPECT_DOUBLE_EQ(median({4, 1, 3, 2}), 2.5);
}

TEST(CompareRatio, EqualValuesHaveNoError) {
    const auto ratio = unpaired_ratio(std::vector<double>(7, 200), std::vector<double>(5, 300));
    EXPECT_DOUBLE_EQ(ratio.value, 1.5);
    EXPECT_NEAR(ratio.low, 1.5, 1e-15);
    EXPECT_NEAR(ratio.high, 1.5, 1e-15);
    EXPECT_EQ(ratio.log_error, 0);
    EXPECT_EQ(paired_ratio(std::vector<double>{0.5}).log_error, 0);
}

TEST(CompareRatio, RepeatsToTheBit) {
    Noise noise(3);
    const auto before = noise.times(9, 0.02);
    const auto after = noise.times(9, 0.02);
    const auto one = unpaired_ratio(before, after);
    const auto two = unpaired_ratio(before, after);
    EXPECT_EQ(one.low, two.low);
    EXPECT_EQ(one.high, two.high);
    EXPECT_EQ(one.log_error, two.log_error);
}

/// The share of many draws in which the interval holds the true ratio of 1.1.
template<class Draw>
double coverage(Draw draw) {
    constexpr int times = 1000;
    int held = 0;
    for (int i = 0; i < times; ++i) {
        const Ratio ratio = draw();
        held += ratio.low <= 1.1 && ratio.high >= 1.1 ? 1 : 0;
    }
    return static_cast<double>(held) / times;
}

// 3 standard errors of 1,000 draws are 2 %; unpaired medians of so few values are held more often.
TEST(CompareRatio, IntervalsHoldTheTruth) {
    Noise noise(4);
    for (const std::size_t rounds : {10, 25}) {
        const double unpaired = coverage([&] {
            auto after = noise.times(rounds, 0.03);
            for (auto& time : after) time *= 1.1;
            return unpaired_ratio(noise.times(rounds, 0.03), after);
        });
        EXPECT_GT(unpaired, 0.94) << rounds;
        EXPECT_LT(unpaired, 0.995) << rounds;
        const double paired = coverage([&] {
            auto logs = noise.normal(rounds, 0.03);
            for (auto& log : logs) log += std::log(1.1);
            return paired_ratio(logs);
        });
        EXPECT_GT(paired, 0.94) << rounds;
        EXPECT_LT(paired, 0.99) << rounds;
    }
}

TEST(CompareRatio, ErrorIsTheDeviationOfWhatIsEstimated) {
    Noise noise(5);
    std::vector<double> logs;
    double errors = 0;
    for (int i = 0; i < 400; ++i) {
        const auto ratio = unpaired_ratio(noise.times(15, 0.03), noise.times(15, 0.03));
        logs.push_back(std::log(ratio.value));
        errors += ratio.log_error / 400;
    }
    double squares = 0;
    for (const auto log : logs) squares += log * log / 400;
    EXPECT_NEAR(errors / std::sqrt(squares), 1, 0.2);
}

TEST(CompareRatio, LeastEffectIsThatOfNormalTests) {
    EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
    EXPECT_NEAR(normal_quantile(0.8), 0.8416212335729143, 1e-12);
    EXPECT_NEAR(normal_quantile(0.5), 0, 1e-12);
    EXPECT_NEAR(normal_quantile(1e-9), -5.99780701500768, 1e-9);
    EXPECT_NEAR(least_effect(0.01, 0.05, 0.8), std::expm1(0.02801585218112968), 1e-12);
    EXPECT_EQ(least_effect(0, 0.05, 0.8), 0);
}

} // namespace
} // namespace tandem::compare
