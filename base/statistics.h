// SPDX-License-Identifier: MIT
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace tandem {

/// Interpolates linearly between order statistics (Hyndman and Fan 1996, definition 7). `sorted` must be
/// ascending and not empty.
double quantile(const std::vector<double>& sorted, double fraction);

/// The median; for an even number of values the mean of the middle two. `values` must not be empty.
double median(std::vector<double> values);
template<std::integral Whole>
double median(const std::vector<Whole>& values) {
    return median(std::vector<double>(values.begin(), values.end()));
}

/// The fraction of resamples to cut on each side, so that the interval has 95 % coverage for n values; 0 for
/// fewer than two. Cutting 2.5 % covers 92 % with ten values (measured on 1,000 pairs of equal cells),
/// because resamples spread less than samples. Expanded percentiles, Hesterberg 2015, "What Teachers Should
/// Know About the Bootstrap", 4.3: Phi(-sqrt(n / (n - 1)) t(0.975; n - 1)).
double interval_tail(std::size_t values);

/// Order statistics of samples. Quartiles interpolate linearly between order statistics (Hyndman and Fan
/// 1996, definition 7). low..high is the 95 % percentile-bootstrap interval of the median (Efron 1979; 1,000
/// resamples from a fixed seed, so that a record can be recomputed), expanded by interval_tail().
struct Summary {
    double median = 0, q1 = 0, q3 = 0, low = 0, high = 0;
};

/// `samples` must not be empty.
Summary summarise(std::span<const std::int64_t> samples);

/// Statistics of the medians of rounds; rounds[i] is the round of samples[i]. Samples of one round share a
/// session and a period of time, so that only rounds are independent. Both spans have the same size and are
/// not empty.
Summary summarise(std::span<const std::int64_t> samples, std::span<const std::uint32_t> rounds);

/// The median of each round, ordered by the number of the round.
std::vector<double> round_medians(std::span<const std::int64_t> samples,
                                  std::span<const std::uint32_t> rounds);

/// Number of values more than five standard deviations away from the median; the standard deviation is
/// estimated as 1.4826 times the median absolute deviation (Hampel 1974). 0 for fewer than eight values, or
/// when more than half are equal.
std::size_t count_outliers(std::span<const double> values);

/// The change of values from first to last, relative to their median: the median of all pairwise slopes (Sen
/// 1968), times the number of values less one. Empty without a significant trend (Mann 1945, p < 0.01), or
/// for fewer than eight values.
std::optional<double> drift(std::span<const double> values);

/// Median and 99th percentile by the nearest rank, and the largest sample.
struct Spread {
    double median = 0, p99 = 0, maximum = 0;
};

/// Empty without samples.
std::optional<Spread> spread(std::vector<double> samples);

} // namespace tandem
