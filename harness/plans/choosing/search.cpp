// SPDX-License-Identifier: MIT
#include "harness/plans/choosing/search.h"

#include "harness/sampling/statistics.h"

#include <algorithm>
#include <bit>

namespace tandem {

namespace {

/// After one replay: processes beside this one have been seen to double a replay, not to take four times as
/// long.
constexpr std::int64_t hopeless = 4;
/// Replays of a candidate in a round that tell what they can.
constexpr std::size_t most_sweeps = 32;
/// Replays from which on candidates whose times do not overlap are told apart before the round ends.
constexpr std::size_t telling = 5;

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
    /// One replay of each; false when time ran out.
    bool sweep(bool backwards);
    /// Another replay; the candidate is dropped when it fails.
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
    std::vector<std::size_t> dropped_; ///< in that order
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

/// Half of the time is left for those that are worth it.
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

/// Of the sorted ones those from `position` on, the slowest first.
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
        return median(times(candidate)) > static_cast<double>(hopeless) * median(times(alive_.front()));
    });
    drop_from(static_cast<std::size_t>(behind - alive_.begin()));
}

/// Those whose fastest replay is slower than the slowest of the best.
void SuccessiveHalving::drop_behind() {
    sort_by_median();
    const auto& best = times(alive_.front());
    if (best.size() < telling) return;
    const auto slowest = *std::max_element(best.begin(), best.end());
    const auto overlaps = [&](auto candidate) {
        return std::ranges::min(times(candidate)) <= slowest || times(candidate).size() < telling;
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

/// There and back: what grows steadily, such as heat, then weighs on all alike.
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
