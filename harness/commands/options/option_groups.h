// SPDX-License-Identifier: MIT
#pragma once

namespace tandem::option_groups {

// The titles of groups of options in a command's help: app.option_defaults()->group(TITLE) begins one.
inline constexpr const char* what = "What to measure";
inline constexpr const char* motion = "What to simulate";
inline constexpr const char* exported = "What to export";
inline constexpr const char* how_long = "How long to measure";
inline constexpr const char* checks = "Checks";
inline constexpr const char* output = "Output";
inline constexpr const char* machine = "Machine";
inline constexpr const char* others = "Options"; ///< those that CLI11 adds, and all of a small command

/// Their order in the help.
inline constexpr const char* all[] = {what, motion, exported, how_long, checks, output, machine, others};

} // namespace tandem::option_groups
