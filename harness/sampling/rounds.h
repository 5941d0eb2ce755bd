// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/cell_sampler.h"
#include "harness/sampling/time_left.h"

namespace tandem {

/// When the sampling of a cell ends.
struct StoppingCriterion {
    std::optional<std::size_t> repeat{}; ///< number of samples; empty: by the other criteria
    std::optional<double> noise{}; ///< relative width of the median's 95 % interval; empty: by its devices
    double seconds = 10;           ///< duration of rounds after which `least` rounds suffice
    static constexpr std::size_t least = 10;
};

/// The criterion's noise; by default 1 % when all devices are GPUs, 3 % otherwise.
double noise_of(const DeviceGroup& devices, const StoppingCriterion& criterion);

/// How a group of cells was sampled, for the record.
struct Sampling {
    StoppingCriterion criterion;
    std::uint64_t seed = 0;   ///< of the order of cells in a round
    std::size_t cells = 1;    ///< number of cells in the group
    bool interrupted = false; ///< before all cells met the criterion
};

/// A cell of a group and its result.
struct Outcome {
    CellSampler* sampler = nullptr;
    std::string failure;        ///< of its device or its memory; empty when it finished
    bool ended = false;         ///< it needs no more rounds
    bool converged = false;     ///< its interval is narrow enough, or it has `repeat` samples
    WorkDone check{};           ///< with the counting replay
    std::size_t next_check = 0; ///< rounds at the next check of the interval, which is slow for many rounds
};

/// Callbacks during the sampling of a group.
struct RoundsListener {
    /// Called with what runs, and the estimated seconds to the end of all cells; none while unknown.
    std::function<void(std::string_view, std::optional<double>)> progress = [](std::string_view,
                                                                               std::optional<double>) {};
    std::size_t later_cells = 0; ///< cells of later groups, for the estimate
    /// Called once for each cell, when it needs no more rounds or has failed.
    std::function<void(const Outcome&, const Sampling&)> finished = [](const Outcome&, const Sampling&) {};
    /// Called after each round of a cell that needs more rounds; `first` for the first round of this run.
    std::function<void(const CellSampler&, bool first)> kept = [](const CellSampler&, bool) {};
    /// Called before each round of a cell.
    std::function<void()> before_round = [] {};
    /// Called between rounds and before each frame: whether to end now with the results so far.
    std::function<bool()> stop = [] { return false; };
};

/// Checks every cell and takes its first round, in the given order. Further rounds visit the cells that do
/// not yet meet the criterion, each in a new random order, so that drift of the machine affects all cells
/// alike. One session lives at a time. Returns whether it was interrupted: then the round that ran is
/// dropped, and cells without a whole round are not finished.
bool sample_group(std::span<CellSampler* const> cells, const CheckOptions& check,
                  const StoppingCriterion& criterion, std::uint64_t seed, const RoundsListener& listener);

} // namespace tandem
