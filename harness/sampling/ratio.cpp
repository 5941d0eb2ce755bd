// SPDX-License-Identifier: MIT
#include "harness/sampling/ratio.h"

#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace tandem {

namespace {

/// The standard specifies this generator's exact output, unlike that of the library's distributions.
using Generator = std::mt19937_64;
constexpr std::uint64_t bootstrap_seed = 20180606;
constexpr std::size_t resamples = 1000;

} // namespace

Ratio paired_ratio(std::span<const double> log_ratios) {
    Generator random(bootstrap_seed);
    std::vector<double> logs(resamples), drawn(log_ratios.size());
    for (auto& log : logs) {
        for (auto& value : drawn) value = log_ratios[random() % log_ratios.size()];
        log = median(drawn);
    }
    std::sort(logs.begin(), logs.end());
    const auto tail = interval_tail(log_ratios.size());
    return {std::exp(median({log_ratios.begin(), log_ratios.end()})), std::exp(quantile(logs, tail)),
            std::exp(quantile(logs, 1 - tail))};
}

} // namespace tandem
