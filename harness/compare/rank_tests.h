// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

namespace tandem::compare {

/// What a two-sided rank test says. `exact`: from the distribution of the ranks by counting, ties included;
/// otherwise from the normal approximation with corrections for ties and continuity.
struct RankTest {
    double p = 1;
    bool exact = true;
};

/// Signed-rank test (Wilcoxon 1945) of pairs whose differences are symmetrical about 0. Differences of 0 are
/// left out, as there; nothing else gives p = 1. Exact up to 50 differences.
RankTest signed_rank_test(std::span<const double> differences);

/// Rank-sum test (Wilcoxon 1945; Mann and Whitney 1947) of two sides with one distribution. Neither is empty.
/// Exact up to 45 values a side, or fewer on one and more on the other.
RankTest rank_sum_test(std::span<const double> before, std::span<const double> after);

/// The least p that these tests can give with so many values, none tied: 2 / 2^pairs and
/// 2 / binomial(before + after, before), at most 1.
double least_signed_rank_p(std::size_t pairs);
double least_rank_sum_p(std::size_t before, std::size_t after);

} // namespace tandem::compare
