// SPDX-License-Identifier: MIT
// p-values against published tables and against every arrangement of ranks.
#include "harness/compare/holm.h"
#include "harness/compare/rank_tests.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <vector>

namespace tandem::compare {
namespace {

/// Differences of sizes 1 to `pairs` of which those that are positive have ranks that add up to `sum`.
std::vector<double> with_rank_sum(int pairs, int sum) {
    std::vector<double> differences;
    for (int rank = pairs; rank > 0; --rank) {
        differences.push_back(rank <= sum ? rank : -rank);
        sum -= rank <= sum ? rank : 0;
    }
    return differences;
}

double signed_rank_p(int pairs, int sum) { return signed_rank_test(with_rank_sum(pairs, sum)).p; }

TEST(CompareRankTests, SignedRanksHaveTheCriticalValuesOfTables) {
    // Two-sided critical values at 5 % (Wilcoxon and Wilcox 1964; in every textbook): the largest smaller
    // sum.
    const std::vector<std::pair<int, int>> critical{{6, 0},   {7, 2},   {8, 3},   {9, 5},   {10, 8},
                                                    {12, 13}, {15, 25}, {20, 52}, {25, 89}, {30, 137}};
    for (const auto& [pairs, sum] : critical) {
        EXPECT_LE(signed_rank_p(pairs, sum), 0.05) << pairs;
        EXPECT_GT(signed_rank_p(pairs, sum + 1), 0.05) << pairs;
    }
    EXPECT_DOUBLE_EQ(signed_rank_p(10, 8), 50.0 / 1024); // 25 of 1,024 sets of ranks add up to 8 or less
    EXPECT_DOUBLE_EQ(signed_rank_p(5, 0), 2.0 / 32);
    EXPECT_DOUBLE_EQ(signed_rank_p(5, 15), 2.0 / 32);
    EXPECT_DOUBLE_EQ(signed_rank_p(3, 3), 1);
}

TEST(CompareRankTests, SignedRanksOfTiesAndZeros) {
    EXPECT_DOUBLE_EQ(signed_rank_test({}).p, 1);
    EXPECT_DOUBLE_EQ(signed_rank_test(std::vector<double>{0, 0, 0}).p, 1);
    // All ranks tie, so this is a sign test: 1 of 6 negative or fewer, 2 * 7 / 64.
    EXPECT_DOUBLE_EQ(signed_rank_test(std::vector<double>{1, 1, 1, 1, 1, -1, 0}).p, 14.0 / 64);
}

/// Signs of `differences` by the bits of a number.
std::vector<double> with_signs(std::vector<double> differences, unsigned bits) {
    for (std::size_t i = 0; i < differences.size(); ++i)
        if (bits >> i & 1) differences[i] = -differences[i];
    return differences;
}

double positive_ranks(const std::vector<double>& differences, const std::vector<double>& ranks) {
    double sum = 0;
    for (std::size_t i = 0; i < ranks.size(); ++i) sum += differences[i] > 0 ? ranks[i] : 0;
    return sum;
}

TEST(CompareRankTests, SignedRanksAreThoseOfEverySign) {
    const std::vector<double> sizes{1, 2, 2, 3, 4, 4, 4, 5};
    const std::vector<double> ranks{1, 2.5, 2.5, 4, 6, 6, 6, 8};
    for (unsigned signs = 0; signs < 256; ++signs) {
        const double own = positive_ranks(with_signs(sizes, signs), ranks);
        int below = 0;
        int above = 0;
        for (unsigned others = 0; others < 256; ++others) {
            const double sum = positive_ranks(with_signs(sizes, others), ranks);
            below += sum <= own ? 1 : 0;
            above += sum >= own ? 1 : 0;
        }
        EXPECT_DOUBLE_EQ(signed_rank_test(with_signs(sizes, signs)).p,
                         std::min(1.0, 2.0 * std::min(below, above) / 256));
    }
}

/// Ranks 1 to all values, `side` of them on one side: the lowest, moved up one at a time until U is `u`.
double rank_sum_p(int side, int other, int u) {
    std::vector<double> one;
    std::vector<double> two;
    for (int rank = 1; rank <= side; ++rank) one.push_back(rank);
    for (int rank = side; rank > 0 && u > 0; --rank) {
        const int up = std::min(u, other);
        one[static_cast<std::size_t>(rank - 1)] += up;
        u -= up;
    }
    for (int rank = 1; rank <= side + other; ++rank)
        if (std::find(one.begin(), one.end(), rank) == one.end()) two.push_back(rank);
    return rank_sum_test(one, two).p;
}

TEST(CompareRankTests, RankSumsHaveTheCriticalValuesOfTables) {
    // Two-sided critical values of U at 5 % (Mann and Whitney 1947; in every textbook).
    const std::vector<std::array<int, 3>> critical{{4, 4, 0},    {4, 6, 2},    {5, 5, 2},    {5, 8, 6},
                                                   {8, 8, 13},   {10, 10, 23}, {10, 15, 39}, {3, 5, 0},
                                                   {15, 15, 64}, {20, 20, 127}};
    for (const auto& [side, other, u] : critical) {
        EXPECT_LE(rank_sum_p(side, other, u), 0.05) << side << " " << other;
        EXPECT_GT(rank_sum_p(side, other, u + 1), 0.05) << side << " " << other;
        EXPECT_DOUBLE_EQ(rank_sum_p(side, other, u), rank_sum_p(side, other, side * other - u));
    }
    // 5 against 5: 1, 1, 2, 3, 5 of 252 arrangements have U = 0, 1, 2, 3, 4.
    const std::array<double, 5> at_most{1, 2, 4, 7, 12};
    for (int u = 0; u < 5; ++u)
        EXPECT_DOUBLE_EQ(rank_sum_p(5, 5, u), 2 * at_most[static_cast<std::size_t>(u)] / 252);
    EXPECT_DOUBLE_EQ(rank_sum_p(3, 3, 0), 0.1);
}

TEST(CompareRankTests, RankSumsOfTiesAreThoseOfEveryArrangement) {
    const std::vector<double> values{1, 1, 2, 3, 3, 3, 5, 6};
    const std::vector<double> ranks{1.5, 1.5, 3, 5, 5, 5, 7, 8};
    const auto sum_of = [&](unsigned set) {
        double sum = 0;
        for (std::size_t i = 0; i < ranks.size(); ++i) sum += set >> i & 1 ? ranks[i] : 0;
        return sum;
    };
    for (unsigned set = 0; set < 256; ++set) {
        if (std::popcount(set) != 3) continue;
        double below = 0;
        double above = 0;
        for (unsigned other = 0; other < 256; ++other) {
            if (std::popcount(other) != 3) continue;
            below += sum_of(other) <= sum_of(set) ? 1 : 0;
            above += sum_of(other) >= sum_of(set) ? 1 : 0;
        }
        std::vector<double> one;
        std::vector<double> two;
        for (std::size_t i = 0; i < values.size(); ++i) (set >> i & 1 ? one : two).push_back(values[i]);
        const double expected = std::min(1.0, 2 * std::min(below, above) / 56);
        EXPECT_DOUBLE_EQ(rank_sum_test(one, two).p, expected);
        EXPECT_DOUBLE_EQ(rank_sum_test(two, one).p, expected);
    }
    EXPECT_DOUBLE_EQ(rank_sum_test(std::vector<double>(5, 1), std::vector<double>(5, 1)).p, 1);
}

TEST(CompareRankTests, ApproximationsGoOnFromWhatIsExact) {
    std::mt19937_64 random(1);
    for (int draw = 0; draw < 20; ++draw) {
        std::vector<double> pairs(50);
        std::vector<double> before(45);
        std::vector<double> after(45);
        for (auto& value : pairs) value = static_cast<double>(random() % 40) - 14.4 - draw * 0.25;
        for (auto& value : before) value = static_cast<double>(random() % 40);
        for (auto& value : after) value = static_cast<double>(random() % 40) + draw * 0.5;
        const auto exact_pairs = signed_rank_test(pairs);
        const auto exact_sums = rank_sum_test(before, after);
        EXPECT_TRUE(exact_pairs.exact && exact_sums.exact);
        // One value more in the middle changes little but the method.
        pairs.push_back(0.001);
        before.push_back(20);
        after.push_back(20);
        const auto pairs_p = signed_rank_test(pairs);
        const auto sums_p = rank_sum_test(before, after);
        EXPECT_FALSE(pairs_p.exact || sums_p.exact);
        EXPECT_NEAR(pairs_p.p, exact_pairs.p, 0.02 + 0.05 * exact_pairs.p);
        EXPECT_NEAR(sums_p.p, exact_sums.p, 0.02 + 0.05 * exact_sums.p);
    }
    EXPECT_DOUBLE_EQ(rank_sum_test(std::vector<double>(60, 1), std::vector<double>(60, 1)).p, 1);
}

TEST(CompareRankTests, ApproximationsByHand) {
    // 60 pairs of ranks 1 to 60, of which those above 20 are positive: W = 1620, mean 915, variance 18452.5.
    std::vector<double> pairs;
    for (int rank = 1; rank <= 60; ++rank) pairs.push_back(rank > 20 ? rank : -rank);
    EXPECT_NEAR(signed_rank_test(pairs).p, std::erfc(704.5 / std::sqrt(18452.5) / std::sqrt(2.0)), 1e-15);
    // 60 pairs that all tie, 40 of them positive: W = 40 * 30.5 = 1220, and the variance is less by (60^3 -
    // 60) / 48.
    std::fill(pairs.begin(), pairs.end(), 1);
    std::fill(pairs.begin(), pairs.begin() + 20, -1);
    EXPECT_NEAR(signed_rank_test(pairs).p, std::erfc(304.5 / std::sqrt(13953.75) / std::sqrt(2.0)), 1e-15);
    // 50 values of 1 and 50 of which 25 are 1: ties of 75 and 25. W = 50 * 38 = 1900, mean 2525,
    // variance 2500 / 12 * (101 - (75^3 - 75 + 25^3 - 25) / 9900).
    std::vector<double> after(50, 1);
    std::fill(after.begin(), after.begin() + 25, 2);
    const double variance = 2500.0 / 12 * (101 - (421800.0 + 15600.0) / 9900);
    EXPECT_NEAR(rank_sum_test(std::vector<double>(50, 1), after).p,
                std::erfc(624.5 / std::sqrt(variance) / std::sqrt(2.0)), 1e-15);
}

TEST(CompareRankTests, LeastValuesAreThoseOfSidesApart) {
    for (int n = 1; n <= 12; ++n) {
        EXPECT_DOUBLE_EQ(least_signed_rank_p(static_cast<std::size_t>(n)), signed_rank_p(n, 0)) << n;
        for (int m = 1; m <= 12; ++m)
            EXPECT_NEAR(least_rank_sum_p(static_cast<std::size_t>(n), static_cast<std::size_t>(m)),
                        rank_sum_p(n, m, 0), 1e-12)
                << n << " " << m;
    }
    EXPECT_GT(least_signed_rank_p(5), 0.05);
    EXPECT_LT(least_signed_rank_p(6), 0.05);
    EXPECT_GT(least_rank_sum_p(3, 4), 0.05);
    EXPECT_LT(least_rank_sum_p(4, 4), 0.05);
}

TEST(CompareHolm, ByHand) {
    // 0.005 * 4, then 0.01 * 3 and 0.03 * 2; 0.04 * 1 is raised to what stands before it.
    const std::vector<double> p{0.01, 0.04, 0.03, 0.005};
    const std::vector<double> expected{0.03, 0.06, 0.06, 0.02};
    const auto corrected = holm(p);
    ASSERT_EQ(corrected.size(), expected.size());
    for (std::size_t i = 0; i < p.size(); ++i) EXPECT_DOUBLE_EQ(corrected[i], expected[i]);
    EXPECT_EQ(holm(std::vector<double>{0.6, 0.7}), (std::vector<double>{1, 1}));
    EXPECT_EQ(holm(std::vector<double>{0.2}), (std::vector<double>{0.2}));
    EXPECT_TRUE(holm({}).empty());
}

} // namespace
} // namespace tandem::compare
