// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/run_options.h"

#include <string>
#include <vector>

namespace tandem {

/// Options of `tandem accuracy`, as given: the options of `tandem run`, applied to each scene.
struct AccuracyOptions {
    std::vector<std::string> scenes;
    RunOptions run;      ///< its scene is not used
    std::string figures; ///< the folder of the figures; empty: none are drawn
};

/// Returns the exit code: 0 ok, 1 a check failed, 3 a device failed. Bad use throws InputError.
int accuracy_command(const AccuracyOptions& options);

} // namespace tandem
