// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace tandem {

/// How many times longer one cell takes than another, with its 95 % interval.
struct Ratio {
    double value = 1, low = 1, high = 1;
};

/// The median of ratios whose logarithms are these, which were taken in pairs; at least one. Its interval is
/// the percentile bootstrap's (Efron 1979; 1,000 resamples from a fixed seed), expanded as interval_tail()
/// says. The same in python/tandem/resampling.py, to the last bits.
Ratio paired_ratio(std::span<const double> log_ratios);

} // namespace tandem
