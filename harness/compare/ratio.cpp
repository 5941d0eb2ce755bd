// SPDX-License-Identifier: MIT
#include "harness/compare/ratio.h"

#include "harness/statistics.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace tandem::compare {

namespace {

/// The generator is specified to the bit, unlike distributions of the library.
using Generator = std::mt19937_64;
constexpr std::uint64_t bootstrap_seed = 20180606;
constexpr std::size_t resamples = 1000;

/// The median of as many values of `values`, drawn with replacement into `drawn`.
double resampled_median(Generator& random, std::span<const double> values, std::vector<double>& drawn) {
    drawn.resize(values.size());
    for (auto& value : drawn) value = values[random() % values.size()];
    const auto middle = drawn.begin() + static_cast<std::ptrdiff_t>(drawn.size() / 2);
    std::nth_element(drawn.begin(), middle, drawn.end());
    if (drawn.size() % 2 == 1) return *middle;
    return (*middle + *std::max_element(drawn.begin(), middle)) / 2;
}

double deviation(std::span<const double> values) {
    double mean = 0;
    for (const auto value : values) mean += value / static_cast<double>(values.size());
    double squares = 0;
    for (const auto value : values) squares += (value - mean) * (value - mean);
    return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

/// From the logarithm of the ratio of so many values, and what draws it anew.
template<class Draw>
Ratio bootstrap(double log_ratio, std::size_t values, Draw draw) {
    Generator random(bootstrap_seed);
    std::vector<double> logs(resamples);
    for (auto& log : logs) log = draw(random);
    std::sort(logs.begin(), logs.end());
    const auto tail = interval_tail(values);
    return {std::exp(log_ratio), std::exp(quantile(logs, tail)), std::exp(quantile(logs, 1 - tail)),
            logs.front() == logs.back() ? 0 : deviation(logs)};
}

} // namespace

Ratio paired_ratio(std::span<const double> log_ratios) {
    std::vector<double> drawn;
    return bootstrap(median({log_ratios.begin(), log_ratios.end()}), log_ratios.size(),
                     [&](Generator& random) { return resampled_median(random, log_ratios, drawn); });
}

Ratio unpaired_ratio(std::span<const double> before, std::span<const double> after) {
    std::vector<double> drawn;
    const auto log_ratio =
        std::log(median({after.begin(), after.end()})) - std::log(median({before.begin(), before.end()}));
    return bootstrap(log_ratio, std::min(before.size(), after.size()), [&](Generator& random) {
        const auto old_median = resampled_median(random, before, drawn);
        return std::log(resampled_median(random, after, drawn)) - std::log(old_median);
    });
}

double least_effect(double log_error, double level, double probability) {
    return std::expm1((normal_quantile(1 - level / 2) + normal_quantile(probability)) * log_error);
}

double normal_quantile(double probability) {
    double low = -40;
    double high = 40;
    for (int halving = 0; halving < 100; ++halving) {
        const double middle = (low + high) / 2;
        (std::erfc(-middle / std::sqrt(2.0)) / 2 < probability ? low : high) = middle;
    }
    return (low + high) / 2;
}

} // namespace tandem::compare
