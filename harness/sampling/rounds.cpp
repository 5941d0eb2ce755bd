// SPDX-License-Identifier: MIT
#include "harness/sampling/rounds.h"

#include "harness/program/interrupt.h"
#include "harness/plans/rank_team.h"
#include "base/statistics.h"

#include <algorithm>
#include <fmt/format.h>
#include <new>
#include <random>

namespace tandem {

namespace {

/// Samples a group of cells.
class Group {
public:
    Group(std::span<CellSampler* const> cells, const CheckOptions& check, const StoppingCriterion& criterion,
          std::uint64_t seed, const RoundsListener& listener)
        : check_(check), listener_(listener), random_(seed) {
        check_.progress = [this](std::string_view text, double fraction) {
            running_->check = {static_cast<double>(since(began_)) * 1e-9, fraction};
            show(text);
        };
        sampling_.criterion = criterion;
        sampling_.seed = seed;
        sampling_.cells = cells.size();
        for (auto* cell : cells) {
            outcomes_.emplace_back().sampler = cell;
            cell->stop_when([this] { return stops(); });
        }
    }

    bool run();

private:
    RankTeam* team() const { return outcomes_.empty() ? nullptr : outcomes_.front().sampler->cell().team; }
    bool stops() const { return decided(team(), listener_.stop()); }
    /// Runs one round of a cell. Returns false when the cell needs no further one: it has failed, it meets
    /// the criterion, or it was interrupted before its first round ended.
    template<class Work>
    bool run_round(Outcome& outcome, bool is_first, const Work& work);
    bool begin(Outcome& outcome);
    bool round(Outcome& outcome);
    bool meets_criterion(Outcome& outcome) const;
    std::size_t next_samples(const CellSampler& cell) const;
    std::string name(const Outcome& outcome) const;
    /// Reports what runs, with the estimated time left.
    void show(std::string_view text) const;
    CellWork work_of(const Outcome& outcome) const;

    CheckOptions check_;
    const RoundsListener& listener_;
    std::mt19937_64 random_;
    Sampling sampling_;
    std::vector<Outcome> outcomes_;
    Outcome* running_ = nullptr; ///< the cell whose check runs
    std::chrono::steady_clock::time_point began_;
};

/// The rounds of a cell end with its samples, or else with its time, but not before the least number.
CellWork Group::work_of(const Outcome& outcome) const {
    const auto& state = outcome.sampler->state();
    const auto& criterion = sampling_.criterion;
    const auto samples = static_cast<double>(state.measurement.samples.size());
    CellWork work{outcome.check, {static_cast<double>(state.spent_ns) * 1e-9, 1}};
    if (outcome.ended) {
        work.check.fraction = 1;
        return work;
    }
    if (criterion.repeat)
        work.rounds.fraction = *criterion.repeat == 0 ? 1 : samples / static_cast<double>(*criterion.repeat);
    else
        work.rounds.fraction = std::min(work.rounds.seconds / criterion.seconds,
                                        static_cast<double>(state.measurement.round_count())
                                            / static_cast<double>(StoppingCriterion::least));
    work.rounds.fraction = std::min(work.rounds.fraction, 1.0);
    return work;
}

void Group::show(std::string_view text) const {
    std::vector<CellWork> work;
    for (const auto& outcome : outcomes_) work.push_back(work_of(outcome));
    const auto& criterion = sampling_.criterion;
    const auto usual = criterion.repeat ? std::nullopt : std::optional(criterion.seconds);
    listener_.progress(text, seconds_left(work, listener_.later_cells, usual));
}

std::size_t Group::next_samples(const CellSampler& cell) const {
    const auto& repeat = sampling_.criterion.repeat;
    if (!repeat) return decided(team(), cell.samples_a_round());
    const auto left = *repeat - std::min(*repeat, cell.measurement().samples.size());
    // One sample a round, unless preparations are long.
    return decided(team(),
                   std::min(left, cell.preparation_is_long() ? cell.samples_a_round() : std::size_t{1}));
}

bool Group::meets_criterion(Outcome& outcome) const {
    auto& cell = *outcome.sampler;
    const auto& m = cell.measurement();
    const auto& criterion = sampling_.criterion;
    if (criterion.repeat) return outcome.converged = m.samples.size() >= *criterion.repeat;
    const std::size_t rounds = m.round_count();
    if (rounds < StoppingCriterion::least) return false;
    const bool is_late = static_cast<double>(cell.state().spent_ns) * 1e-9 >= criterion.seconds;
    if (!is_late && rounds < outcome.next_check) return false;
    outcome.next_check = rounds + rounds / 10;
    const auto s = summarise(m.totals(), m.rounds());
    outcome.converged = s.high - s.low <= noise_of(cell.cell().devices, criterion) * s.median;
    return outcome.converged || is_late;
}

template<class Work>
bool Group::run_round(Outcome& outcome, bool is_first, const Work& work) {
    try {
        work();
        if (!decided(team(), meets_criterion(outcome))) {
            listener_.kept(*outcome.sampler, is_first);
            return true;
        }
    } catch (const Interrupted&) {
        outcome.sampler->release();
        const bool has_round = !outcome.sampler->measurement().breakdowns.empty();
        // Later rounds have been kept when they ended.
        if ((is_first || !has_round) && outcome.sampler->state().is_checked())
            listener_.kept(*outcome.sampler, true);
        return has_round;
    } catch (const DeviceError& error) {
        // An error of a single rank ends the job, because the other ranks wait for that rank.
        if (team() != nullptr && dynamic_cast<const OfAllRanks*>(&error) == nullptr) throw;
        outcome.failure = error.what();
    } catch (const std::bad_alloc&) {
        if (team() != nullptr) throw;
        outcome.failure = "out of host memory; use fewer bodies or frames";
    }
    outcome.sampler->release();
    outcome.ended = true;
    listener_.finished(outcome, sampling_);
    return false;
}

bool Group::begin(Outcome& outcome) {
    auto& cell = *outcome.sampler;
    running_ = &outcome;
    began_ = std::chrono::steady_clock::now();
    return run_round(outcome, true, [&] {
        const bool is_resumed = cell.state().is_checked();
        if (!is_resumed) cell.check(check_);
        outcome.check = {is_resumed ? 0 : static_cast<double>(since(began_)) * 1e-9, 1};
        if (cell.measurement().breakdowns.empty()) {
            // The device waited for the host during the check; begin the first round as every other round,
            // with a new session.
            if (next_samples(cell) > 0) cell.release();
            show(fmt::format("{}: first round", name(outcome)));
            listener_.before_round();
            cell.round(next_samples(cell));
        }
        const auto counting = std::chrono::steady_clock::now();
        if (check_.count_work) cell.count_work();
        outcome.check.seconds += static_cast<double>(since(counting)) * 1e-9;
        cell.release();
    });
}

bool Group::round(Outcome& outcome) {
    auto& cell = *outcome.sampler;
    show(fmt::format("{}: round {}", name(outcome), cell.measurement().round_count() + 1));
    return run_round(outcome, false, [&] {
        listener_.before_round();
        cell.round(next_samples(cell));
        cell.release();
    });
}

std::string Group::name(const Outcome& outcome) const { return describe(outcome.sampler->cell()); }

bool Group::run() {
    // Resumed cells can have different numbers of rounds. All continue at the largest number, because cells
    // are compared by rounds of equal number.
    std::uint32_t next = 0;
    for (const auto& outcome : outcomes_) next = std::max(next, outcome.sampler->state().rounds);
    for (auto& outcome : outcomes_) outcome.sampler->resume_at(next);
    std::vector<Outcome*> left;
    for (auto& outcome : outcomes_) {
        if (stops()) break;
        if (begin(outcome)) left.push_back(&outcome);
    }
    while (!left.empty() && !stops()) {
        // Unlike std::shuffle, this gives the same order with every standard library.
        for (std::size_t i = left.size(); i > 1; --i) std::swap(left[i - 1], left[random_() % i]);
        std::vector<Outcome*> remaining;
        for (auto* outcome : left)
            if (stops() || round(*outcome)) remaining.push_back(outcome);
        left = std::move(remaining);
    }
    sampling_.interrupted = stops();
    for (auto* outcome : left) listener_.finished(*outcome, sampling_);
    return sampling_.interrupted;
}

} // namespace

double noise_of(const DeviceGroup& devices, const StoppingCriterion& criterion) {
    if (criterion.noise) return *criterion.noise;
    const bool gpus = std::ranges::all_of(devices, [](const auto* device) { return device->info().is_gpu; });
    return gpus ? 0.01 : 0.03;
}

bool sample_group(std::span<CellSampler* const> cells, const CheckOptions& check,
                  const StoppingCriterion& criterion, std::uint64_t seed, const RoundsListener& listener) {
    return Group(cells, check, criterion, seed, listener).run();
}

} // namespace tandem
