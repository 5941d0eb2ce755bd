// SPDX-License-Identifier: MIT
#include "base/statistics.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace tandem {

double quantile(const std::vector<double>& sorted, double fraction) {
    const double at = fraction * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(std::floor(at));
    const auto above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (at - std::floor(at)) * (sorted[above] - sorted[below]);
}

namespace {

/// Ascending medians of resamples of the same size, drawn with replacement from ascending samples. Every
/// machine computes the same interval: the seed is fixed, and the standard specifies the generator's exact
/// output, unlike that of the library's distributions. A resample is how often each sample was drawn, so that
/// none is sorted.
std::vector<double> bootstrap_medians(const std::vector<double>& sorted) {
    std::mt19937_64 random(20180606);
    std::vector<double> medians(1000);
    std::vector<std::uint32_t> drawn(sorted.size());
    const auto middle = (sorted.size() - 1) / 2; // the lower one of two
    for (auto& median : medians) {
        std::ranges::fill(drawn, 0U);
        for (std::size_t i = 0; i < sorted.size(); ++i) ++drawn[random() % sorted.size()];
        std::size_t below = 0;
        std::size_t values = drawn[0]; // of the resample, up to sorted[below]
        while (values <= middle) values += drawn[++below];
        auto above = below;
        if (sorted.size() % 2 == 0 && values == middle + 1)
            while (drawn[++above] == 0) {}
        median = sorted[below] + 0.5 * (sorted[above] - sorted[below]);
    }
    std::ranges::sort(medians);
    return medians;
}

/// t with 97.5 % of Student's distribution below it.
double student_quantile(std::size_t freedom) {
    const boost::math::students_t distribution(static_cast<double>(freedom));
    return boost::math::quantile(boost::math::complement(distribution, 0.025));
}

Summary summary_of(std::vector<double> sorted) {
    std::sort(sorted.begin(), sorted.end());
    Summary summary{quantile(sorted, 0.5), quantile(sorted, 0.25), quantile(sorted, 0.75), sorted.front(),
                    sorted.back()};
    // Every resample has the same median.
    if (sorted.front() == sorted.back()) return summary;
    const auto medians = bootstrap_medians(sorted);
    const auto tail = interval_tail(sorted.size());
    summary.low = quantile(medians, tail);
    summary.high = quantile(medians, 1 - tail);
    return summary;
}

} // namespace

double interval_tail(std::size_t values) {
    if (values < 2) return 0;
    const auto n = static_cast<double>(values);
    const double width = std::sqrt(n / (n - 1)) * student_quantile(values - 1);
    return std::erfc(width / std::numbers::sqrt2) / 2;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return quantile(values, 0.5);
}

Summary summarise(std::span<const std::int64_t> samples) {
    return summary_of({samples.begin(), samples.end()});
}

Summary summarise(std::span<const std::int64_t> samples, std::span<const std::uint32_t> rounds) {
    return summary_of(round_medians(samples, rounds));
}

std::vector<double> round_medians(std::span<const std::int64_t> samples,
                                  std::span<const std::uint32_t> rounds) {
    std::map<std::uint32_t, std::vector<double>> by_round;
    for (std::size_t i = 0; i < samples.size(); ++i)
        by_round[rounds[i]].push_back(static_cast<double>(samples[i]));
    std::vector<double> medians;
    medians.reserve(by_round.size());
    for (auto& [round, values] : by_round) medians.push_back(median(std::move(values)));
    return medians;
}

std::size_t count_outliers(std::span<const double> values) {
    if (values.size() < 8) return 0;
    const double middle = median({values.begin(), values.end()});
    std::vector<double> deviations;
    for (const double value : values) deviations.push_back(std::abs(value - middle));
    const double deviation = 1.4826 * median(deviations);
    if (deviation == 0) return 0;
    return static_cast<std::size_t>(
        std::ranges::count_if(deviations, [&](double d) { return d > 5 * deviation; }));
}

std::optional<double> drift(std::span<const double> values) {
    const auto n = static_cast<double>(values.size());
    if (values.size() < 8) return std::nullopt;
    double concordance = 0;
    std::vector<double> slopes;
    for (std::size_t i = 0; i < values.size(); ++i)
        for (auto j = i + 1; j < values.size(); ++j) {
            const double change = values[j] - values[i];
            concordance += change > 0 ? 1 : (change < 0 ? -1 : 0);
            slopes.push_back(change / static_cast<double>(j - i));
        }
    // Approximately normal from eight values on; the 1 is the continuity correction for steps of two.
    const double deviation = std::sqrt(n * (n - 1) * (2 * n + 5) / 18);
    if (std::abs(concordance) - 1 < 2.5758 * deviation) return std::nullopt; // two-sided, 99 %
    return median(std::move(slopes)) * (n - 1) / median({values.begin(), values.end()});
}

std::optional<Spread> spread(std::vector<double> samples) {
    if (samples.empty()) return std::nullopt;
    std::sort(samples.begin(), samples.end());
    // The nearest rank is always a sample, never an interpolation of two.
    const auto at = [&](double fraction) {
        const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(samples.size())));
        return samples[std::max<std::size_t>(rank, 1) - 1];
    };
    return Spread{at(0.5), at(0.99), samples.back()};
}

} // namespace tandem
