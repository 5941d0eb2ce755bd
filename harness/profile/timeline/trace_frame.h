// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/task.h"
#include "harness/profile/timeline/timeline.h"

namespace tandem {

/// The timeline of the middle frame of a cell. Replays the frames up to it and runs it twice, the second time
/// with a clock around every command. May throw DeviceError.
nlohmann::ordered_json trace_frame(const Cell& cell, const Task& task);

} // namespace tandem
