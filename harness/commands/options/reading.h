// SPDX-License-Identifier: MIT
// Options on how mesh files are read, of every command that reads meshes.
#pragma once

#include "scenes/mesh_reading.h"

namespace CLI {
class App;
} // namespace CLI

namespace tandem {

/// Adds --duplicates, --weld, --pressure, --corners and --only-tetrahedra. `reading` must outlive the
/// parsing.
void add_reading_options(CLI::App& app, MeshReading& reading);

} // namespace tandem
