// SPDX-License-Identifier: MIT
// Options on how mesh files are read, of every command that reads meshes.
#pragma once

#include "scenes/mesh_reading.h"

#include <vector>

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace tandem {

/// Adds --duplicates, --weld, --corners and --only-tetrahedra. `reading` must outlive the parsing.
void add_reading_options(CLI::App& app, MeshReading& reading);

/// The same options for an external subcommand that passes them to 'tandem export', which checks them.
std::vector<CLI::Option*> add_external_reading_options(CLI::App& app);

} // namespace tandem
