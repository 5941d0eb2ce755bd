// SPDX-License-Identifier: MIT
#include "harness/sampling/time_left.h"

namespace tandem {

namespace {

/// Seconds left of one part of all cells. `usual`: of a whole part, while none has begun. Parts that took no
/// time were done before, or have failed.
std::optional<double> left_of(std::span<const CellWork> cells, std::size_t later, WorkDone CellWork::*part,
                              std::optional<double> usual) {
    double seconds = 0, begun = 0;
    for (const auto& cell : cells)
        if ((cell.*part).fraction > 0 && (cell.*part).seconds > 0)
            seconds += (cell.*part).seconds, begun += (cell.*part).fraction;
    const auto mean = begun > 0 ? std::optional(seconds / begun) : usual;
    double left = 0;
    std::size_t whole = later;
    for (const auto& cell : cells) {
        const auto& own = cell.*part;
        if (own.fraction > 0)
            left += own.seconds * (1 - own.fraction) / own.fraction;
        else
            ++whole;
    }
    if (whole > 0 && !mean) return std::nullopt;
    return left + static_cast<double>(whole) * mean.value_or(0);
}

} // namespace

std::optional<double> seconds_left(std::span<const CellWork> cells, std::size_t later,
                                   std::optional<double> usual_rounds) {
    const auto checks = left_of(cells, later, &CellWork::check, std::nullopt);
    const auto rounds = left_of(cells, later, &CellWork::rounds, usual_rounds);
    if (!checks || !rounds) return std::nullopt;
    return *checks + *rounds;
}

} // namespace tandem
