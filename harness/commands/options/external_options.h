// SPDX-License-Identifier: MIT
// External subcommands. Their options are declared for help, completion and hints, and are passed on
// unchanged.
#pragma once

#include "harness/commands/options/actions.h"

#include <string>
#include <vector>

namespace CLI {
class Option;
}

namespace tandem {

/// Adds an option or argument whose value an external subcommand reads.
CLI::Option* add_external_option(CLI::App& app, const std::string& name, const std::string& description);

/// Adds a flag that an external subcommand reads.
CLI::Option* add_external_flag(CLI::App& app, const std::string& name, const std::string& description);

/// The given options of a subcommand as "--name=value" or "--flag", then "--" and the arguments.
std::vector<std::string> given_words(const CLI::App& app);

/// Returns the action that runs the external subcommand of this name with the given words.
Action run_external_action(const CLI::App& app);

} // namespace tandem
