// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace tandem {

/// What a search asks for; candidates are numbered from 0.
struct SearchSteps {
    /// Nanoseconds of one replay, none when the candidate fails. The first prepares the candidate as well,
    /// which is in no replay's time.
    std::function<std::optional<std::int64_t>(std::size_t)> replay;
    std::function<double()> measured;                           ///< seconds that replays have taken
    std::function<double()> preparing;                          ///< seconds of everything else
    std::function<void(std::size_t)> drop = [](std::size_t) {}; ///< will not be asked for again
};

/// Seconds that a search may take. A replay or a preparation that has begun is finished, and one candidate is
/// replayed in any case.
struct SearchLimits {
    double measuring = 10;
    double preparing = 60;
};

/// What a search found.
struct SearchResult {
    std::vector<std::vector<std::int64_t>> replays; ///< [candidate] ns; empty: not tried, or failed at once
    /// Those that did not fail, the fastest first, then in the reverse of the order in which they were
    /// dropped; empty when all failed.
    std::vector<std::size_t> ranking;
};

/// Finds the fastest of so many candidates: one replay of each, which drops what takes more than four times
/// the least; then rounds of interleaved replays, an equal share of the time each, after which the slower
/// half by the median is dropped (successive halving; Karnin, Koren and Somekh 2013).
SearchResult search(std::size_t count, const SearchSteps& steps, const SearchLimits& limits);

} // namespace tandem
