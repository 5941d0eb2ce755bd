// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace tandem {

/// The operations of a search; candidates are numbered from 0.
struct SearchSteps {
    /// Replays a candidate and returns nanoseconds; none when it fails. The first replay also prepares the
    /// candidate, which is not in the returned time.
    std::function<std::optional<std::int64_t>(std::size_t)> replay;
    std::function<double()> measured;                           ///< seconds that replays have taken
    std::function<double()> preparing;                          ///< seconds of everything else
    std::function<void(std::size_t)> drop = [](std::size_t) {}; ///< the candidate is not replayed again
};

/// Limits of a search in seconds. A replay or preparation that has begun is finished. At least one candidate
/// is replayed.
struct SearchLimits {
    double measuring = 10;
    double preparing = 60;
};

/// The result of a search.
struct SearchResult {
    std::vector<std::vector<std::int64_t>> replays; ///< [candidate] ns; empty: not tried, or failed
    /// The candidates that did not fail: the fastest first, then the dropped ones, the last dropped first.
    /// Empty when all failed.
    std::vector<std::size_t> ranking;
};

/// Finds the fastest of `count` candidates. First it replays each once and drops those above four times the
/// least time. Then each round replays the rest in turns and drops the slower half by the median; all rounds
/// get the same time (successive halving; Karnin, Koren and Somekh 2013).
SearchResult search(std::size_t count, const SearchSteps& steps, const SearchLimits& limits);

} // namespace tandem
