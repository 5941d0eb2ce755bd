// SPDX-License-Identifier: MIT
#pragma once

#include "harness/simulate/command.h"
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

/// One run of a simulation, which successive processes may continue: its recording, if any, with checkpoints.
/// A checkpoint has a digest of the settings, a number that identifies the run, and the state of the
/// simulation. The digest prevents a run from continuing with other settings.
class SimulationSession {
public:
    /// Begins a recording, or opens one to continue it. Throws InputError when it cannot.
    SimulationSession(const SimulateOptions& options, const Scene& scene, const Cell& cell);

    /// Restores the simulation from the last checkpoint. Throws InputError when that has other settings.
    void restore(Simulation& simulation);
    /// Records the frame of a step. Throws OutputError when it cannot be written.
    void append(const StepReport& report, const Frame& frame);
    /// Writes a checkpoint. Throws OutputError when it cannot be written.
    void save(const Simulation& simulation);

    std::size_t frames() const { return writer_ ? writer_->frames() : 0; }
    /// The number that identifies the run; after restore() the number in the checkpoint.
    std::uint64_t number() const { return number_; }

private:
    std::span<const std::byte> read_number(std::span<const std::byte> state);

    std::string settings_;
    std::uint64_t number_;
    std::optional<RecordingWriter> writer_;
};

/// The name of a session in records.
std::string session_name(std::uint64_t number);

/// The steps of a session that have a line in the file.
std::set<std::size_t> steps_recorded(const RecordFile& file, std::uint64_t session);

} // namespace tandem
