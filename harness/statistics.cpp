// SPDX-License-Identifier: MIT
#include "harness/statistics.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace tandem {

double quantile(const std::vector<double>& sorted, double fraction) {
    const double at = fraction * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(std::floor(at));
    const auto above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (at - std::floor(at)) * (sorted[above] - sorted[below]);
}

namespace {

/// Ascending medians of resamples of the same size, drawn with replacement. The seed is fixed and the
/// generator specified to the bit, unlike distributions of the library, so that every machine gives the same
/// interval.
std::vector<double> bootstrap_medians(const std::vector<double>& samples) {
    std::mt19937_64 random(20180606);
    std::vector<double> medians(1000);
    std::vector<double> drawn(samples.size());
    for (auto& median : medians) {
        for (auto& value : drawn) value = samples[random() % samples.size()];
        std::sort(drawn.begin(), drawn.end());
        median = quantile(drawn, 0.5);
    }
    std::sort(medians.begin(), medians.end());
    return medians;
}

} // namespace

Summary summarise(std::span<const std::int64_t> samples) {
    std::vector<double> sorted(samples.begin(), samples.end());
    std::sort(sorted.begin(), sorted.end());
    Summary summary{quantile(sorted, 0.5), quantile(sorted, 0.25), quantile(sorted, 0.75), sorted.front(),
                    sorted.back()};
    // Every resample has the same median.
    if (sorted.front() == sorted.back()) return summary;
    const auto medians = bootstrap_medians(sorted);
    summary.low = quantile(medians, 0.025);
    summary.high = quantile(medians, 0.975);
    return summary;
}

std::optional<Spread> spread(std::vector<double> samples) {
    if (samples.empty()) return std::nullopt;
    std::sort(samples.begin(), samples.end());
    // The nearest rank: always a sample, never a mixture of two.
    const auto at = [&](double share) {
        const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(samples.size())));
        return samples[std::max<std::size_t>(rank, 1) - 1];
    };
    return Spread{at(0.5), at(0.99), samples.back()};
}

} // namespace tandem
