// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace tandem {

/// Ratio of the times of two cells, with its 95 % interval.
struct Ratio {
    double value = 1, low = 1, high = 1;
};

/// The median of paired ratios, given as their logarithms; at least one. The interval is a percentile
/// bootstrap (Efron 1979; 1,000 resamples from a fixed seed), expanded by interval_tail().
Ratio paired_ratio(std::span<const double> log_ratios);

} // namespace tandem
