// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands/run_groups.h"

namespace tandem {

/// --dry-run: lists the cells with their estimated times. A scene that cannot
/// be opened yet, such as a missing recording, does not hide the other groups; the exit code is then 2.
int list_cells(const RunGroups& all, const RunOptions& options, RankTeam* team);

} // namespace tandem
