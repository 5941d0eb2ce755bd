// SPDX-License-Identifier: MIT
// The subcommands of the program: each function adds a command's options and returns what to do with them.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace tandem {

/// What a command does once the whole line has been read; returns the exit code. Bad use throws InputError.
using Action = std::function<int()>;

Action add_run(CLI::App& app);
Action add_check(CLI::App& app);
Action add_isolated(CLI::App& app); ///< for --isolate: see isolated_command()
Action add_accuracy(CLI::App& app);
Action add_profile(CLI::App& app);
Action add_compare(CLI::App& app);
Action add_simulate(CLI::App& app);
Action add_export(CLI::App& app);
Action add_paper(CLI::App& app);
Action add_report(CLI::App& app);
Action add_view(CLI::App& app);
Action add_devices(CLI::App& app);
Action add_scenes(CLI::App& app);
Action add_algorithms(CLI::App& app);
Action add_completion(CLI::App& app);

} // namespace tandem
