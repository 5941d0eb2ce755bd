// SPDX-License-Identifier: MIT
#include "harness/compare/report.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem::compare {

namespace {

std::string percent(double share) { return fmt::format("{:g} %", 100 * share); }

/// "3 %", or each with its kind of device where they are the defaults and both occur.
std::string thresholds(const Report& report) {
    const auto& cells = report.comparison.cells;
    const auto [least, most] = std::ranges::minmax(cells, {}, &ComparedCell::threshold);
    if (least.threshold == most.threshold) return percent(least.threshold);
    return fmt::format("{} (GPUs) or {} (processors)", percent(least.threshold), percent(most.threshold));
}

/// "; the others could have shown 0.8 to 2.1 %".
std::string others(const Report& report) {
    std::vector<double> effects;
    std::size_t decided = 0;
    for (const auto& cell : report.comparison.cells) {
        const bool is_other = cell.verdict == Verdict::not_shown || cell.verdict == Verdict::within_threshold;
        if (is_other && cell.least_effect) effects.push_back(100 * *cell.least_effect);
        decided += is_other || cell.verdict == Verdict::too_few ? 0 : 1;
    }
    if (effects.empty()) return {};
    const auto [least, most] = std::ranges::minmax(effects);
    const auto low = fmt::format("{:.1f}", least);
    const auto high = fmt::format("{:.1f}", most);
    return fmt::format("; {} could have shown {}{} %", decided > 0 ? "the others" : "they", low,
                       low == high ? "" : " to " + high);
}

std::string too_few(const Report& report) {
    const auto count = report.comparison.count(Verdict::too_few);
    if (count == 0) return {};
    const auto& cells = report.comparison.cells;
    const auto needed = std::ranges::max(cells, {}, &ComparedCell::rounds_needed).rounds_needed;
    return fmt::format("; {} {} too few samples to tell: {} rounds of each would do", count,
                       count == 1 ? "has" : "have", needed);
}

} // namespace

std::string summary(const Report& report) {
    const auto& comparison = report.comparison;
    const auto answers = comparison.count(Verdict::another_answer);
    const auto within = comparison.count(Verdict::within_threshold);
    auto text = fmt::format("{} of {} {} slower, {} faster beyond {} at level {:g}",
                            comparison.count(Verdict::slower), comparison.cells.size(),
                            comparison.cells.size() == 1 ? "cell" : "cells",
                            comparison.count(Verdict::faster), thresholds(report), report.options.level);
    if (answers > 0) text += fmt::format("; {} with another answer", answers);
    if (within > 0) text += fmt::format("; {} changed within the threshold", within);
    return text + too_few(report) + others(report);
}

} // namespace tandem::compare
