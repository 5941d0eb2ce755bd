// SPDX-License-Identifier: MIT
// External subcommands, which are written in Python: they declare their options, and the program passes words
// on.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace tandem {

/// Adds the options that an external subcommand of this name declares, for completion. Adds none where it
/// cannot be run.
void add_declared_options(CLI::App& app, const std::string& name);

} // namespace tandem
