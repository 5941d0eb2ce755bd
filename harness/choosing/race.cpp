// SPDX-License-Identifier: MIT
#include "harness/choosing/race.h"

#include "harness/plans/candidates.h"
#include "base/statistics.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Preparation gets more time: a GPU's compiler takes a second or two, a frame about a millisecond.
constexpr double preparing_per_measuring = 6;
/// Background processes have doubled the time of a replay in measurements, but never quadrupled it.
constexpr double hopeless_factor = 4;
/// More replays of a candidate in a round add no information.
constexpr std::size_t most_sweeps = 32;
/// After so many replays, candidates whose times do not overlap are told apart.
constexpr std::size_t least_replays = 5;

bool is_crowded(const Device* device) {
    const auto capacity = std::min<std::uint64_t>(device->info().global_bytes, device->memory_limit());
    return device->bytes_allocated() > capacity / 4;
}

/// The number of kernel files that its devices compile at the same time. Ranks prepare one after the other,
/// because each preparation is collective.
std::size_t compilers_of(const Cell& cell) {
    std::size_t least =
        cell.team != nullptr || cell.devices.empty() ? 1 : cell.devices.front()->info().compilers;
    for (const auto* device : cell.devices) least = std::min<std::size_t>(least, device->info().compilers);
    return least;
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

} // namespace

/// Does work with a candidate. An error ends it.
template<class Work>
bool Race::survives(std::size_t candidate, const Work& work) {
    auto& own = runners_[candidate];
    try {
        work();
        return true;
    } catch (const DeviceError& error) {
        own.failure = error.what();
    } catch (const InputError& error) {
        own.failure = error.what();
    }
    own.times.clear();
    free(candidate);
    return false;
}

void Race::free(std::size_t candidate) {
    steps_.free(candidate);
    runners_[candidate].has_session = false;
}

void Race::free_all() {
    for (std::size_t i = 0; i < runners_.size(); ++i) free(i);
}

/// Makes the sessions of a candidate and of those after it, as many as its device compiles at the same time.
/// If one of them fails, each is prepared on its own.
void Race::prepare_ahead(std::size_t first) {
    if (first < ahead_) return;
    ahead_ = std::min(candidates_.size(), first + compilers_of(candidates_[first]));
    if (ahead_ - first < 2) return;
    const auto begin = std::chrono::steady_clock::now();
    const auto free_new = [&] {
        for (auto i = first; i < ahead_; ++i) free(i);
    };
    try {
        compile_together(candidates_[first].devices, [&] {
            for (auto i = first; i < ahead_; ++i) steps_.prepare(i);
        });
    } catch (const DeviceError&) {
        free_new();
    } catch (const InputError&) {
        free_new();
    }
    preparing_ += seconds_since(begin);
}

bool Race::prepare(std::size_t candidate) {
    if (!failure(candidate).empty()) return false;
    if (runners_[candidate].has_session) return true;
    const auto begin = std::chrono::steady_clock::now();
    const auto make = [&] { // also replays once, so that kernels are compiled and buffers grow
        steps_.prepare(candidate);
        replay(candidate);
        runners_[candidate].has_session = true;
    };
    const bool works = survives(candidate, [&] {
        if (steps_.decided(std::ranges::any_of(candidates_[candidate].devices, is_crowded)) != 0) free_all();
        try {
            make();
        } catch (const OutOfMemory&) {
            free_all();
            make();
        }
    });
    preparing_ += steps_.decided(seconds_since(begin));
    return works;
}

/// Returns the nanoseconds. Throws DeviceError for another answer than the first one.
std::int64_t Race::replay(std::size_t candidate) {
    const auto own = steps_.replay(candidate);
    const bool compares_contacts = may_differ_in_k(candidates_[candidate]);
    const auto count = compares_contacts ? own.contacts : own.pairs;
    if (found_.value_or(count) != count)
        throw DeviceError(fmt::format("found {} {}, the first candidate {}", count,
                                      compares_contacts ? "contacts" : "candidate pairs", *found_));
    if (!found_) pairs_ = own.pairs;
    found_ = count;
    return own.ns;
}

std::uint64_t Race::pairs() {
    for (std::size_t i = 0; i < candidates_.size(); ++i)
        if (prepare(i)) break;
    return pairs_;
}

void Race::try_once(std::size_t candidate) {
    steps_.progress(candidate);
    const bool works = prepare(candidate) && survives(candidate, [&] {
                           runners_[candidate].times.push_back(replay(candidate));
                           measured_ += 1e-9 * static_cast<double>(times(candidate).back());
                       });
    if (!works) std::erase(alive_, candidate);
}

/// Keeps the first `count` candidates; the slowest are dropped first.
void Race::keep(std::size_t count) {
    for (; alive_.size() > count; alive_.pop_back()) {
        dropped_.push_back(alive_.back());
        free(alive_.back());
    }
}

/// Drops hopeless candidates, and those whose fastest replay is slower than the slowest of the best one.
void Race::drop_behind() {
    if (alive_.empty()) return;
    std::ranges::stable_sort(alive_, {}, [&](auto candidate) { return median(times(candidate)); });
    const auto& best = times(alive_.front());
    const auto rest = std::ranges::stable_partition(alive_, [&](auto candidate) {
        const auto& own = times(candidate);
        const bool is_apart = std::min(own.size(), best.size()) >= least_replays
                              && std::ranges::min(own) > std::ranges::max(best);
        return !is_apart && median(own) <= hopeless_factor * median(best);
    });
    keep(alive_.size() - rest.size());
}

std::vector<std::size_t> Race::run(double seconds) {
    // At least half of the time is left for the best ones.
    const auto has_time = [&] {
        return measured_ < seconds / 2 && preparing_ < preparing_per_measuring * seconds;
    };
    for (std::size_t i = 0; i < candidates_.size() && (alive_.empty() || has_time()); ++i) {
        prepare_ahead(i);
        alive_.push_back(i);
        try_once(i);
        drop_behind();
    }
    while (alive_.size() > 1 && measured_ < seconds) {
        const auto rounds = std::bit_width(alive_.size() - 1); // halvings until one is left
        const auto end = measured_ + (seconds - measured_) / static_cast<double>(rounds);
        const auto half = (alive_.size() + 1) / 2;
        // Sweeps alternate in direction, so that a steady drift, such as heat, affects all candidates alike.
        for (std::size_t i = 0; i < most_sweeps && alive_.size() > 1 && measured_ < end; ++i) {
            auto order = alive_;
            if (i % 2 == 1) std::ranges::reverse(order);
            for (const auto candidate : order)
                if (measured_ < seconds) try_once(candidate);
            drop_behind();
        }
        if (measured_ < seconds) keep(half);
    }
    auto ranking = alive_;
    ranking.insert(ranking.end(), dropped_.rbegin(), dropped_.rend());
    return ranking;
}

} // namespace tandem
