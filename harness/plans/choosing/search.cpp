// SPDX-License-Identifier: MIT
#include "harness/plans/choosing/search.h"

#include "harness/sampling/statistics.h"

#include <algorithm>
#include <bit>

namespace tandem {

namespace {

/// A candidate is dropped after one replay that takes so many times the best median. Background processes
/// have doubled the time of a replay in measurements, but never quadrupled it.
constexpr std::int64_t hopeless_factor = 4;
/// Maximum number of replays of a candidate in a round; more replays add no information.
constexpr std::size_t most_sweeps = 32;
/// After so many replays, candidates whose times do not overlap are separated before the round ends.
constexpr std::size_t least_replays = 5;

class SuccessiveHalving {
public:
    SuccessiveHalving(std::size_t count, const SearchSteps& steps, const SearchLimits& limits)
        : steps_(steps), limits_(limits) {
        result_.replays.resize(count);
    }

    SearchResult run();

private:
    void try_all();
    void play_round();
    /// Replays each remaining candidate once; false when time ran out.
    bool sweep(bool backwards);
    /// Replays a candidate, which is removed when it fails.
    void replay(std::size_t candidate);
    void drop_hopeless();
    void drop_behind();
    void sort_by_median();
    void drop_from(std::size_t position);
    bool has_time() const { return steps_.measured() < limits_.measuring; }
    std::vector<std::int64_t>& times(std::size_t candidate) { return result_.replays[candidate]; }

    const SearchSteps& steps_;
    SearchLimits limits_;
    SearchResult result_;
    std::vector<std::size_t> alive_;
    std::vector<std::size_t> dropped_; ///< in the order of dropping
};

void SuccessiveHalving::replay(std::size_t candidate) {
    if (const auto time = steps_.replay(candidate)) {
        times(candidate).push_back(*time);
        return;
    }
    times(candidate).clear();
    std::erase(alive_, candidate);
    steps_.drop(candidate);
}

/// Replays each candidate once. At least half of the time is left for the best ones.
void SuccessiveHalving::try_all() {
    for (std::size_t candidate = 0; candidate < result_.replays.size(); ++candidate) {
        const bool late =
            steps_.measured() >= limits_.measuring / 2 || steps_.preparing() >= limits_.preparing;
        if (late && !alive_.empty()) break;
        alive_.push_back(candidate);
        replay(candidate);
        drop_hopeless();
    }
}

void SuccessiveHalving::sort_by_median() {
    std::stable_sort(alive_.begin(), alive_.end(),
                     [&](auto a, auto b) { return median(result_.replays[a]) < median(result_.replays[b]); });
}

/// Drops the sorted candidates from `position` on, the slowest first.
void SuccessiveHalving::drop_from(std::size_t position) {
    while (alive_.size() > position) {
        dropped_.push_back(alive_.back());
        steps_.drop(alive_.back());
        alive_.pop_back();
    }
}

void SuccessiveHalving::drop_hopeless() {
    sort_by_median();
    const auto behind = std::find_if(alive_.begin(), alive_.end(), [&](auto candidate) {
        return median(times(candidate))
               > static_cast<double>(hopeless_factor) * median(times(alive_.front()));
    });
    drop_from(static_cast<std::size_t>(behind - alive_.begin()));
}

/// Drops the candidates whose fastest replay is slower than the slowest replay of the best candidate.
void SuccessiveHalving::drop_behind() {
    sort_by_median();
    const auto& best = times(alive_.front());
    if (best.size() < least_replays) return;
    const auto slowest = *std::max_element(best.begin(), best.end());
    const auto overlaps = [&](auto candidate) {
        return std::ranges::min(times(candidate)) <= slowest || times(candidate).size() < least_replays;
    };
    drop_from(static_cast<std::size_t>(std::stable_partition(alive_.begin(), alive_.end(), overlaps)
                                       - alive_.begin()));
}

bool SuccessiveHalving::sweep(bool backwards) {
    auto order = alive_;
    if (backwards) std::reverse(order.begin(), order.end());
    for (const auto candidate : order) {
        if (!has_time()) return false;
        replay(candidate);
    }
    return has_time();
}

/// Sweeps alternate in direction, so that a steady drift, such as heat, affects all candidates alike.
void SuccessiveHalving::play_round() {
    const auto rounds = std::bit_width(alive_.size() - 1); // halvings until one is left
    const auto now = steps_.measured();
    const auto end = now + (limits_.measuring - now) / static_cast<double>(rounds);
    const auto half = (alive_.size() + 1) / 2;
    for (std::size_t i = 0; i < most_sweeps && alive_.size() > 1; ++i) {
        if (!sweep(i % 2 == 1) || alive_.empty() || steps_.measured() >= end) break;
        drop_behind();
    }
    sort_by_median();
    if (has_time()) drop_from(std::min(half, alive_.size()));
}

SearchResult SuccessiveHalving::run() {
    try_all();
    while (alive_.size() > 1 && has_time()) play_round();
    sort_by_median();
    result_.ranking = alive_;
    result_.ranking.insert(result_.ranking.end(), dropped_.rbegin(), dropped_.rend());
    return std::move(result_);
}

} // namespace

SearchResult search(std::size_t count, const SearchSteps& steps, const SearchLimits& limits) {
    return SuccessiveHalving(count, steps, limits).run();
}

} // namespace tandem
