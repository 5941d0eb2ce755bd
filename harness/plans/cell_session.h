// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"

#include <memory>
#include <vector>

namespace tandem {

/// The settings that a session of the cell has, as the key of its record lists them. Throws InputError.
Settings session_settings(const Cell& cell, const Scene& scene);
/// Prepares a session of a cell on this process, or on all ranks of its team.
std::unique_ptr<Session> prepare_session(const Cell& cell, const Scene& scene);
/// The devices of a cell, or those of all ranks of its team.
std::vector<DeviceInfo> infos_of(const Cell& cell);

} // namespace tandem
