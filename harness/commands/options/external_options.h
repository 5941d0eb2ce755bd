// SPDX-License-Identifier: MIT
// External subcommands: options are declared here, so that help, completion and hints know them, and handed
// over as they were given.
#pragma once

#include "harness/commands/options/actions.h"

#include <string>
#include <vector>

namespace CLI {
class Option;
}

namespace tandem {

/// Adds an option, or an argument, whose value an external subcommand reads.
CLI::Option* add_external_option(CLI::App& app, const std::string& name, const std::string& description);

/// A flag of one.
CLI::Option* add_external_flag(CLI::App& app, const std::string& name, const std::string& description);

/// The options of a subcommand that the line has, as "--name=value" or "--flag", then "--" and the arguments.
std::vector<std::string> given_words(const CLI::App& app);

/// Runs the external subcommand of this name with what was given.
Action run_external_action(const CLI::App& app);

} // namespace tandem
