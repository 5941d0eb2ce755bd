// SPDX-License-Identifier: MIT
// The parts of the record of a cell, for make_record() alone.
#pragma once

#include "harness/sampling/rounds.h"

#include <nlohmann/json.hpp>

namespace tandem::record_parts {

using Json = nlohmann::ordered_json;

/// From "total_ns" to "host_work": of a cell that failed what there is.
void add_times(Json& record, const Measurement& m, bool measured);

/// How several devices shared its frames; null on one.
Json partition_json(const Measurement& m, const Cell& cell);

/// How it was sampled, and what is to be thought of it.
Json sampling_json(const Measurement& m, const Cell& cell, const Outcome& outcome, const Sampling& sampling);

/// What the machine was like in its rounds; null where none has samples.
Json conditions_json(const Measurement& m);

/// Errors against the truth, and what was wrong with the input.
Json error_json(const Measurement& m, const Flaws& flaws);

} // namespace tandem::record_parts
