// SPDX-License-Identifier: MIT
// Options on how mesh files are read, of every command that reads meshes.
#pragma once

#include "scenes/mesh_reading.h"

#include <string>
#include <vector>

namespace CLI {
class App;
} // namespace CLI

namespace tandem {

/// Adds --mesh and --pose. The lists must outlive the parsing.
void add_mesh_options(CLI::App& app, std::vector<std::string>& meshes, std::vector<std::string>& poses);

/// Adds --duplicates, --weld, --pressure, --corners and --only-tetrahedra. `reading` must outlive the
/// parsing.
void add_reading_options(CLI::App& app, MeshReading& reading);

} // namespace tandem
