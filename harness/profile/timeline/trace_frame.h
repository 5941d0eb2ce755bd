// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/job.h"
#include "harness/profile/timeline/timeline.h"

namespace tandem {

/// One more replay of a cell, up to the frame in the middle, which is run twice, the second time with a clock
/// around every command: its timeline. May throw DeviceError.
nlohmann::ordered_json trace_frame(const Cell& cell, const Job& job);

} // namespace tandem
