// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/run_options.h"

#include <string>

namespace tandem {

/// Options of `tandem profile`, as given: the options of `tandem run` for one scene, and these.
struct ProfileOptions {
    RunOptions run;
    std::string ceilings; ///< a file with records of ceilings; empty: they are measured
    bool all = false;     ///< one row for every kernel, however short
};

/// Returns the exit code: 0 ok, 1 a check failed, 3 a device failed. Bad use throws InputError.
int profile_command(const ProfileOptions& options);

} // namespace tandem
