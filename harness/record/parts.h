// SPDX-License-Identifier: MIT
// The parts of a cell's record: their fields, as record.cpp joins them.
#pragma once

#include "harness/program/environment.h"
#include "harness/fields/types.h"
#include "harness/sampling/rounds.h"

namespace tandem::record_parts {

/// What the fields of a record are taken from.
struct CellRecord {
    const Cell& cell;
    const Scene& scene;
    const FrameRange& range;
    const Measurement& m;
    const Outcome& outcome;
    const Sampling& sampling;

    /// Whether the cell finished. A failed cell has only what was measured before the failure.
    bool is_measured() const { return outcome.failure.empty(); }
};

/// A device of a cell. `clock`: by what its times were taken; empty for a device without times.
struct RecordedDevice {
    DeviceInfo info;
    std::optional<std::string> clock;
};

const Fields<Scene>& scene_fields();
const Fields<RecordedDevice>& device_fields();
const Fields<Environment>& environment_fields();

/// "sampling" and "conditions".
Fields<CellRecord> sampling_fields();
/// From "total_ns" to "host_work".
Fields<CellRecord> time_fields();
/// "partition": the work of each of several devices, frame by frame.
Fields<CellRecord> partition_fields();
/// From "work" to "agreement".
Fields<CellRecord> answer_fields();
/// "error": errors against the truth, and the flaws of the input.
Fields<CellRecord> error_fields();

} // namespace tandem::record_parts
