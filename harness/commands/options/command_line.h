// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands/options/actions.h"

#include <string>

namespace tandem {

/// Parses a command line without running anything. Returns the action of the command, or an action that
/// prints help, the version or completions. Throws InputError, a message of one line, for any mistake.
Action read_command_line(int argc, const char* const* argv);

/// Whether the word names an external subcommand (harness/program/external.h).
bool is_external(const std::string& word);

} // namespace tandem
