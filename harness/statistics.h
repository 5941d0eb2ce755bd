// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace tandem {

/// Linear between order statistics (Hyndman and Fan 1996, definition 7). `sorted` ascends and is not empty.
double quantile(const std::vector<double>& sorted, double fraction);

/// Order statistics of samples. Quartiles interpolate linearly between order statistics (Hyndman and Fan
/// 1996, definition 7); low..high is the 95 % percentile-bootstrap interval of the median (Efron 1979; 1,000
/// resamples from a fixed seed, so that a record can be recomputed).
struct Summary {
    double median = 0, q1 = 0, q3 = 0, low = 0, high = 0;
};

/// `samples` must not be empty.
Summary summarise(std::span<const std::int64_t> samples);

/// Median and 99th percentile (the least sample that so many do not exceed) and the largest sample.
struct Spread {
    double median = 0, p99 = 0, maximum = 0;
};

/// Nothing of no samples.
std::optional<Spread> spread(std::vector<double> samples);

} // namespace tandem
