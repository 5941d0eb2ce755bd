// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/run_options.h"

namespace tandem {

/// `tandem run`. Returns the exit code: 0 ok, 1 a check failed, 3 a device failed. Bad use throws InputError.
int run_command(const RunOptions& options);

} // namespace tandem
