// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"
#include "harness/commands.h"

namespace tandem {

/// `tandem run PLAN.json` over the ranks of a job, of which this is the first: deals cells to ranks as they
/// become free, appends their records, prints their tables. The others obey() meanwhile. Returns the exit
/// code, as run_command(); throws InputError.
int sweep_command(const RunOptions& options, Ranks& ranks);

} // namespace tandem
