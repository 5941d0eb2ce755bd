// SPDX-License-Identifier: MIT
#include "harness/compare/rank_tests.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace tandem::compare {

namespace {

constexpr std::size_t most_pairs = 50;
/// Of the smaller side's values times all values: counting takes twice the square of it in steps.
constexpr std::size_t most_sums = 4096;

/// Ranks from 1, doubled so that those of ties, which share their mean, are integers.
struct Ranks {
    std::vector<std::size_t> doubled; ///< in the order of the values
    double ties = 0;                  ///< sum of t^3 - t over groups of t equal values
};

Ranks ranks_of(std::span<const double> values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return values[a] < values[b]; });
    Ranks ranks{std::vector<std::size_t>(values.size()), 0};
    for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
        while (end < order.size() && values[order[end]] == values[order[first]]) ++end;
        for (auto i = first; i < end; ++i) ranks.doubled[order[i]] = first + end + 1;
        const auto tied = static_cast<double>(end - first);
        ranks.ties += tied * tied * tied - tied;
    }
    return ranks;
}

/// Twice the smaller tail of a distribution, counted by sum, at `sum`.
double two_sided(std::span<const double> counts, std::size_t sum) {
    const auto at = counts.begin() + static_cast<std::ptrdiff_t>(sum);
    const double below = std::accumulate(counts.begin(), at, 0.0);
    const double above = std::accumulate(at + 1, counts.end(), 0.0);
    return std::min(1.0, 2 * (std::min(below, above) + *at) / (below + *at + above));
}

/// By the normal distribution: a sum of ranks so far from its mean, half a step towards it.
RankTest approximate(double sum, double mean, double variance) {
    if (variance <= 0) return {1, false};
    const double z = std::max(0.0, std::abs(sum - mean) - 0.5) / std::sqrt(variance);
    return {std::erfc(z / std::sqrt(2.0)), false};
}

/// How many of the sets of `ranks` have each sum.
std::vector<double> count_sets(std::span<const std::size_t> ranks) {
    std::vector<double> counts(std::accumulate(ranks.begin(), ranks.end(), std::size_t{0}) + 1);
    counts[0] = 1;
    for (const auto rank : ranks)
        for (auto sum = counts.size() - 1; sum >= rank; --sum) counts[sum] += counts[sum - rank];
    return counts;
}

/// How many of the sets of `size` of `ranks` have each sum.
std::vector<double> count_sets(std::vector<std::size_t> ranks, std::size_t size) {
    std::sort(ranks.begin(), ranks.end());
    const auto largest = ranks.end() - static_cast<std::ptrdiff_t>(size);
    const auto sums = std::accumulate(largest, ranks.end(), std::size_t{0}) + 1;
    std::vector<double> counts((size + 1) * sums);
    counts[0] = 1;
    for (const auto rank : ranks)
        for (auto taken = size; taken > 0; --taken)
            for (auto sum = sums - 1; sum >= rank; --sum)
                counts[taken * sums + sum] += counts[(taken - 1) * sums + sum - rank];
    return {counts.end() - static_cast<std::ptrdiff_t>(sums), counts.end()};
}

} // namespace

RankTest signed_rank_test(std::span<const double> differences) {
    std::vector<double> sizes;
    std::vector<bool> positive;
    for (const auto difference : differences) {
        if (difference == 0) continue;
        sizes.push_back(std::abs(difference));
        positive.push_back(difference > 0);
    }
    const auto ranks = ranks_of(sizes);
    std::size_t sum = 0;
    for (std::size_t i = 0; i < sizes.size(); ++i) sum += positive[i] ? ranks.doubled[i] : 0;
    if (sizes.size() <= most_pairs) return {two_sided(count_sets(ranks.doubled), sum), true};
    const auto n = static_cast<double>(sizes.size());
    return approximate(static_cast<double>(sum) / 2, n * (n + 1) / 4,
                       n * (n + 1) * (2 * n + 1) / 24 - ranks.ties / 48);
}

RankTest rank_sum_test(std::span<const double> before, std::span<const double> after) {
    // Of the smaller side, which takes less counting; the test is the same.
    if (before.size() > after.size()) std::swap(before, after);
    std::vector<double> all(before.begin(), before.end());
    all.insert(all.end(), after.begin(), after.end());
    const auto ranks = ranks_of(all);
    const auto own = ranks.doubled.begin() + static_cast<std::ptrdiff_t>(before.size());
    const auto sum = std::accumulate(ranks.doubled.begin(), own, std::size_t{0});
    if (before.size() * all.size() <= most_sums)
        return {two_sided(count_sets(ranks.doubled, before.size()), sum), true};
    const auto n = static_cast<double>(before.size());
    const auto m = static_cast<double>(after.size());
    return approximate(static_cast<double>(sum) / 2, n * (n + m + 1) / 2,
                       n * m / 12 * (n + m + 1 - ranks.ties / ((n + m) * (n + m - 1))));
}

double least_signed_rank_p(std::size_t pairs) {
    return std::min(1.0, std::ldexp(2.0, -static_cast<int>(std::min<std::size_t>(pairs, 1000))));
}

double least_rank_sum_p(std::size_t before, std::size_t after) {
    double p = 2;
    for (std::size_t i = 1; i <= std::min(before, after); ++i)
        p *= static_cast<double>(i) / static_cast<double>(std::max(before, after) + i);
    return std::min(1.0, p);
}

} // namespace tandem::compare
