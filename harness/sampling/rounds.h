// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/cell_sampler.h"

namespace tandem {

/// When a cell has been sampled enough.
struct StoppingCriterion {
    std::optional<std::size_t> repeat{}; ///< so many samples; none: as the rest says
    std::optional<double> noise{}; ///< width of the median's 95 % interval, relative; none: by its devices
    double seconds = 10;           ///< of rounds; then `least` rounds suffice
    static constexpr std::size_t least = 10;
};

/// 1 % where all devices are GPUs, 3 % where one is a processor.
double noise_of(const DeviceGroup& devices, const StoppingCriterion& enough);

/// How a group of cells was sampled, as a record says it.
struct Sampling {
    StoppingCriterion enough;
    std::uint64_t seed = 0;   ///< of the order of cells in a round
    std::size_t cells = 1;    ///< of the group, in turn in every round
    bool interrupted = false; ///< before all were sampled enough
};

/// A cell of a group, and what became of it.
struct Outcome {
    CellSampler* sampler = nullptr;
    std::string failure;       ///< of its device or its memory; empty when it finished
    bool converged = false;    ///< its interval is narrower than asked for; always so with `repeat`
    std::size_t next_look = 0; ///< rounds at which to ask again: many take as long to judge as to sample
};

/// What a group tells while it is sampled.
struct RoundsListener {
    std::function<void(std::string_view)> progress = [](std::string_view) {};
    /// A cell that needs no more rounds, or has failed; once each.
    std::function<void(const Outcome&, const Sampling&)> finished = [](const Outcome&, const Sampling&) {};
    /// Of a cell that needs more rounds: after the first that it took here, and after each of the others.
    std::function<void(const CellSampler&, bool first)> kept = [](const CellSampler&, bool) {};
    /// Asked between rounds of cells: whether to end now, with what there is.
    std::function<bool()> stop = [] { return false; };
};

/// Checks every cell and takes its first round, in the order given; then goes round by round through those
/// that have not been sampled enough, in an order drawn for every round, so that drift of the machine is
/// shared by all cells and does not look like an effect. One session lives at a time. Returns whether it was
/// interrupted.
bool sample_group(std::span<CellSampler* const> cells, const CheckOptions& check,
                  const StoppingCriterion& enough, std::uint64_t seed, const RoundsListener& listener);

} // namespace tandem
