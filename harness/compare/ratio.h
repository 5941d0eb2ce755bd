// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

namespace tandem::compare {

/// New time over old time; above 1 is slower. low..high is its 95 % percentile-bootstrap interval (Efron
/// 1979; 1,000 resamples from a fixed seed, so that every machine gives the same figures), expanded as
/// interval_tail says for the side of fewer values, `log_error` the
/// standard error of its natural logarithm from the same resamples. One value a side, or values that are all
/// equal, have an error of 0.
struct Ratio {
    double value = 1, low = 1, high = 1;
    double log_error = 0;
};

/// The exponential of the median of the logarithms of each pair's ratio; pairs are resampled. Not empty.
Ratio paired_ratio(std::span<const double> log_ratios);

/// The ratio of the medians; each side is resampled by itself. Values are above 0, neither side is empty.
Ratio unpaired_ratio(std::span<const double> before, std::span<const double> after);

/// The least relative change, 0.01 for 1 %, that a two-sided test at `level` shows with probability
/// `probability` where the logarithm of the ratio is normal with this standard error: exp((z(1 - level / 2) +
/// z(probability)) * log_error) - 1.
double least_effect(double log_error, double level, double probability);

/// z with a share `probability` of the standard normal distribution below it; 0 < probability < 1.
double normal_quantile(double probability);

} // namespace tandem::compare
