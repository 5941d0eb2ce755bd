// SPDX-License-Identifier: MIT
// The parts of a cell's record; only make_record() uses them.
#pragma once

#include "harness/sampling/rounds.h"

#include <nlohmann/json.hpp>

namespace tandem::record_parts {

using Json = nlohmann::ordered_json;

/// Adds the fields from "total_ns" to "host_work". A failed cell has only what was measured before the
/// failure.
void add_times(Json& record, const Measurement& m, bool measured);

/// The work of each of several devices, frame by frame; null for one device.
Json partition_json(const Measurement& m, const Cell& cell);

/// How the cell was sampled, with outliers and drift as measures of quality.
Json sampling_json(const Measurement& m, const Cell& cell, const Outcome& outcome, const Sampling& sampling);

/// The condition of the machine in the cell's rounds; null when no round has samples.
Json conditions_json(const Measurement& m);

/// Errors against the truth, and the flaws of the input.
Json error_json(const Measurement& m, const Flaws& flaws);

} // namespace tandem::record_parts
