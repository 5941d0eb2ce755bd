// SPDX-License-Identifier: MIT
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace tandem {

/// Linear between order statistics (Hyndman and Fan 1996, definition 7). `sorted` ascends and is not empty.
double quantile(const std::vector<double>& sorted, double fraction);

/// The median: of an even number the mean of the middle two. `values` must not be empty.
double median(std::vector<double> values);
template<std::integral Whole>
double median(const std::vector<Whole>& values) {
    return median(std::vector<double>(values.begin(), values.end()));
}

/// The share of resamples below, and of those above, an interval that holds what was estimated from so many
/// values in 95 % of cases. Between 2.5 % of each, percentiles of ten values hold 92 % (pairs of equal cells,
/// 1,000): resamples spread less than samples do. Expanded percentiles, Hesterberg 2015, "What Teachers
/// Should Know About the Bootstrap", 4.3: Phi(-sqrt(n / (n - 1)) t(0.975; n - 1)). 0 of fewer than two
/// values.
double interval_tail(std::size_t values);

/// Order statistics of samples. Quartiles interpolate linearly between order statistics (Hyndman and Fan
/// 1996, definition 7); low..high is the 95 % percentile-bootstrap interval of the median (Efron 1979; 1,000
/// resamples from a fixed seed, so that a record can be recomputed), expanded as interval_tail says.
struct Summary {
    double median = 0, q1 = 0, q3 = 0, low = 0, high = 0;
};

/// `samples` must not be empty.
Summary summarise(std::span<const std::int64_t> samples);

/// Of samples that were taken in rounds: rounds[i] is the round of samples[i]. Samples of a round share its
/// luck (a session, a stretch of time), so that rounds are what is independent: all statistics are those of
/// the rounds' medians. As many rounds as samples; not empty.
Summary summarise(std::span<const std::int64_t> samples, std::span<const std::uint32_t> rounds);

/// The median of each round, in the order of the rounds' numbers.
std::vector<double> round_medians(std::span<const std::int64_t> samples,
                                  std::span<const std::uint32_t> rounds);

/// How many lie beyond five standard deviations of the median, estimated by 1.4826 times the median absolute
/// deviation (Hampel 1974). None of fewer than eight values, or where more than half are equal.
std::size_t count_outliers(std::span<const double> values);

/// By how much values change from first to last, relative to their median, where they change in one direction
/// (Mann 1945, p < 0.01, eight values at least): the median of all slopes between two of them (Sen 1968),
/// times their number less one. None where they do not.
std::optional<double> drift(std::span<const double> values);

/// Median and 99th percentile (the least sample that so many do not exceed) and the largest sample.
struct Spread {
    double median = 0, p99 = 0, maximum = 0;
};

/// Nothing of no samples.
std::optional<Spread> spread(std::vector<double> samples);

} // namespace tandem
