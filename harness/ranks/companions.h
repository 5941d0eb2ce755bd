// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"
#include "harness/commands.h"
#include "harness/plans/cells.h"
#include "harness/ranks/own_device.h"
#include "harness/sampling/measurement.h"

#include <memory>

namespace tandem {

/// What the first rank of a job has the others do when a cell is measured on all of them: it alone plans,
/// checks, times and records; they open the same scene, keep a session each, and run the frames that they are
/// told. One at a time; other ranks are in serve_companion() meanwhile.
class Companions {
public:
    /// Calls the others from what they wait in. Throws InputError when options ask for what ranks cannot do
    /// together.
    Companions(Ranks& ranks, const RunOptions& options);
    /// Sends the others home.
    ~Companions();
    Companions(const Companions&) = delete;
    Companions& operator=(const Companions&) = delete;

    /// What the options ask for with the first rank's device in the place of all ranks'. Throws InputError.
    RunOptions own_options(const RunOptions& options);
    /// All open the scene and the frames that these options name, and their devices. Throws InputError of
    /// whichever rank cannot.
    void open(const RunOptions& options, const Device& own);
    /// A session of all ranks; on its results the first rank's parts, and parts that are asked of others.
    std::unique_ptr<Session> prepare(const Cell& cell, const Scene& scene);
    /// Frame number `index` of the range is the next to be run; returns when all have it and devices idle.
    void next(std::size_t index);
    void set_clocks(Clocks clocks);
    /// By rank: what its device did since the last time, with clocks on. The first one's is left empty.
    std::vector<StageSamples> stages();
    /// Of all ranks.
    const std::vector<DeviceInfo>& devices() const { return devices_; }

private:
    Ranks& ranks_;
    std::string names_; ///< of devices, "cuda:0+cuda:1"
    PlaceOnMachine place_;
    std::vector<DeviceInfo> devices_;
};

/// Those of this process; null where it works alone.
Companions* companions();

/// The work of the other ranks, until the first one sends them home. Who cannot go on ends the job.
void serve_companion(Ranks& ranks);

/// A session of a cell: of this process alone, or of all ranks.
std::unique_ptr<Session> prepare_session(const Cell& cell, const Scene& scene);
/// Tells companions, if there are some, which frame comes next.
void announce_frame(std::size_t index);
/// What a cell runs on: its devices, or those of all ranks.
std::vector<DeviceInfo> infos_of(const DeviceGroup& devices);

} // namespace tandem
