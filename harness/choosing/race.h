// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tandem {

/// What a replay of the frames found, and the nanoseconds that it took.
struct Replayed {
    std::int64_t ns = 0;
    std::uint64_t pairs = 0, contacts = 0;
};

/// How a candidate, by its number, is run. With ranks, calls are collective.
struct RaceSteps {
    std::function<void(std::size_t)> prepare; ///< makes its session, unless it has one
    std::function<Replayed(std::size_t)> replay;
    std::function<void(std::size_t)> free;                                  ///< frees its session
    std::function<double(double)> decided = [](double own) { return own; }; ///< the value of rank 0
    std::function<void(std::size_t)> progress = [](std::size_t) {};         ///< before it is tried
};

/// Finds the fastest of several cells by successive halving (Karnin, Koren and Somekh 2013). Sessions are
/// kept while they use at most a quarter of a device's memory, because a session that lacks memory runs in
/// batches; freed ones are prepared again when needed. `candidates` must outlive this object.
class Race {
public:
    Race(std::span<const Cell> candidates, RaceSteps steps)
        : candidates_(candidates), steps_(std::move(steps)), runners_(candidates.size()) {}

    /// Candidate pairs of a replay, by the first candidate that works; 0 when none does.
    std::uint64_t pairs();
    /// Replays each candidate once and drops those above four times the least median. Then each round replays
    /// the rest in turns, and drops the slower half by the median; all rounds get the same time. Replays take
    /// `seconds` and preparations six times as long; what has begun is finished, and one candidate is tried
    /// in any case. Returns those that did not fail: the fastest first, then the dropped ones, the last
    /// dropped first.
    std::vector<std::size_t> run(double seconds);

    std::span<const Cell> candidates() const { return candidates_; }
    /// Nanoseconds of each replay; empty: not tried, or failed.
    const std::vector<std::int64_t>& times(std::size_t candidate) const { return runners_[candidate].times; }
    /// Why it failed, in one line: its device failed, its settings do not fit the scene, or it found another
    /// number of pairs (of contacts, if candidates may differ in k) than the first; else empty.
    const std::string& failure(std::size_t candidate) const { return runners_[candidate].failure; }
    double measured() const { return measured_; }   ///< seconds of replays
    double preparing() const { return preparing_; } ///< seconds of everything else

private:
    struct Runner {
        bool has_session = false;
        std::vector<std::int64_t> times;
        std::string failure;
    };

    template<class Work>
    bool survives(std::size_t candidate, const Work& work);
    bool prepare(std::size_t candidate);
    void prepare_ahead(std::size_t first);
    void free(std::size_t candidate);
    void free_all();
    std::int64_t replay(std::size_t candidate);
    void try_once(std::size_t candidate);
    void drop_behind();
    void keep(std::size_t count);

    std::span<const Cell> candidates_;
    RaceSteps steps_;
    std::vector<Runner> runners_;
    std::vector<std::size_t> alive_, dropped_; ///< dropped: in the order of dropping
    std::optional<std::uint64_t> found_;       ///< pairs, or contacts, of the first candidate that works
    std::uint64_t pairs_ = 0;
    std::size_t ahead_ = 0; ///< prepare_ahead() has prepared the candidates before this one
    double measured_ = 0, preparing_ = 0;
};

} // namespace tandem
