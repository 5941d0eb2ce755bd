// SPDX-License-Identifier: MIT
#include "harness/sampling/ratio.h"
#include "tests/support/test.h"

#include <random>

namespace tandem {
namespace {

/// Samples of the normal distribution with this deviation, the same on every machine (Box and Muller 1958).
std::vector<double> noise(std::mt19937_64& random, std::size_t count, double deviation) {
    const auto fraction = [&] { return (static_cast<double>(random() >> 11) + 0.5) / 9007199254740992.0; };
    std::vector<double> values(count);
    for (auto& value : values) {
        const double radius = std::sqrt(-2 * std::log(fraction()));
        value = deviation * radius * std::cos(6.283185307179586 * fraction());
    }
    return values;
}

TEST(SamplingRatio, ByHand) {
    const std::vector<double> logs{std::log(1.1), std::log(1.2), std::log(1.4)};
    EXPECT_DOUBLE_EQ(paired_ratio(logs).value, 1.2);
}

TEST(SamplingRatio, EqualValuesHaveNoInterval) {
    const auto ratio = paired_ratio(std::vector<double>(7, 0.5));
    EXPECT_DOUBLE_EQ(ratio.low, ratio.value);
    EXPECT_DOUBLE_EQ(ratio.high, ratio.value);
}

/// The seed and the generator are fixed, so that a run on any machine has these numbers.
TEST(SamplingRatio, IsReproducible) {
    std::vector<double> logs;
    for (int i = 0; i < 12; ++i) logs.push_back(0.01 * (i * 7 % 11) - 0.03);
    const auto ratio = paired_ratio(logs);
    EXPECT_NEAR(ratio.value, 1.015113064615719, 1e-14);
    EXPECT_NEAR(ratio.low, 0.9801986733067553, 1e-14);
    EXPECT_NEAR(ratio.high, 1.0512710963760241, 1e-14);
}

// Three standard errors of 1,000 draws are 2 %.
TEST(SamplingRatio, IntervalsContainTheTruth) {
    std::mt19937_64 random(4);
    for (const std::size_t rounds : {10, 25}) {
        int containing = 0;
        for (int i = 0; i < 1000; ++i) {
            auto logs = noise(random, rounds, 0.03);
            for (auto& log : logs) log += std::log(1.1);
            const auto ratio = paired_ratio(logs);
            containing += ratio.low <= 1.1 && ratio.high >= 1.1 ? 1 : 0;
        }
        EXPECT_GT(containing, 940) << rounds;
        EXPECT_LT(containing, 990) << rounds;
    }
}

} // namespace
} // namespace tandem
