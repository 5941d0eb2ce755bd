// SPDX-License-Identifier: MIT
// The options that several commands have which measure or check cells: run, check, accuracy, profile.
#pragma once

#include "harness/plans/run_options.h"

namespace CLI {
class App;
class Validator;
} // namespace CLI

namespace tandem {

inline constexpr auto scene_help =
    "NAME, NAME:par=value,..., a scene description (.json) or a recording (.frames)";

/// Adds the options that all of these commands have; `options` must outlive the parsing.
void add_run_options(CLI::App& app, RunOptions& options);

/// Accepts seconds from 0.001 to `most`.
CLI::Validator seconds_up_to(double most);

/// Adds when a cell has been sampled enough, and the order of cells.
void add_sampling(CLI::App& app, RunOptions& options);

void add_no_check(CLI::App& app, RunOptions& options);
void add_check_afresh(CLI::App& app, RunOptions& options);
void add_trace(CLI::App& app, RunOptions& options);

} // namespace tandem
