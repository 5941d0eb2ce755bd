// SPDX-License-Identifier: MIT
#include "harness/commands/options/external_options.h"

#include "harness/program/external.h"
#include "base/error.h"

#include <CLI/CLI.hpp>
#include <sstream>

namespace tandem {

void add_declared_options(CLI::App& app, const std::string& name) {
    std::istringstream lines;
    try {
        lines.str(output_of_external(name, {"--list-options"}));
    } catch (const InputError&) {
        return;
    }
    for (std::string line; std::getline(lines, line);) {
        const auto blank = line.find(' ');
        const auto names = line.substr(0, blank);
        if (names == "-h,--help") continue; // every subcommand has it
        if (blank == std::string::npos)
            app.add_flag(names);
        else
            app.add_option(names, CLI::callback_t{})->option_text(line.substr(blank + 1));
    }
}

} // namespace tandem
