// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands/commands.h"
#include "harness/record/journal.h"
#include "scenes/recording/writer.h"
#include "scenes/simulate/simulation.h"

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace tandem {

/// A run of a simulation, which several processes may do one after the other: its recording, if there is to
/// be one, with the state that goes into its checkpoints. That is the simulation's, behind a digest of its
/// settings, so that nothing goes on with other settings, and a number that tells the run from any other.
class SimulationSession {
public:
    /// Begins a recording or opens one to go on with. Throws InputError when it cannot.
    SimulationSession(const SimulateOptions& options, const Scene& scene, const Cell& cell);

    /// Brings the simulation to the last checkpoint. Throws InputError when that has other settings.
    void restore(Simulation& simulation);
    /// The frame of a step, and a checkpoint after it. Throw OutputError when they cannot be written.
    void append(const StepReport& report, const Frame& frame);
    void save(const Simulation& simulation);

    std::size_t frames() const { return writer_ ? writer_->frames() : 0; }
    /// After restore() that of the checkpoint.
    std::uint64_t number() const { return number_; }

private:
    std::span<const std::byte> read_number(std::span<const std::byte> state);

    std::string settings_;
    std::uint64_t number_;
    std::optional<RecordingWriter> writer_;
};

/// How lines name a session.
std::string session_name(std::uint64_t number);

/// The steps of a session that a file has lines of.
std::set<std::size_t> steps_recorded(const RecordFile& file, std::uint64_t session);

} // namespace tandem
