// SPDX-License-Identifier: MIT
// The subcommands of the program: each function adds the options of a command and returns its action.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace tandem {

/// Runs a command after the whole line has been read, and returns the exit code. Throws InputError on bad
/// use.
using Action = std::function<int()>;

Action add_run(CLI::App& app);
Action add_check(CLI::App& app);
Action add_isolated(CLI::App& app); ///< internal, the child process of --isolate: see isolated_command()
Action add_accuracy(CLI::App& app);
Action add_profile(CLI::App& app);
Action add_simulate(CLI::App& app);
Action add_export(CLI::App& app);
Action add_devices(CLI::App& app);
Action add_scenes(CLI::App& app);
Action add_algorithms(CLI::App& app);
Action add_completion(CLI::App& app);
Action add_help(CLI::App& app);

} // namespace tandem
