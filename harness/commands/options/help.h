// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tandem {

/// The help of the program or of one of its commands, in lines of the terminal's width, 80 characters without
/// a terminal: what it does, its usage, commands or options by group, and the examples that are the footer of
/// `app`, one a line. What an option takes is its option_text; an argument has its own name in capitals
/// without one.
std::string help_text(const CLI::App& app);

/// The commands that the help lists.
std::vector<const CLI::App*> listed_commands(const CLI::App& app);

} // namespace tandem
