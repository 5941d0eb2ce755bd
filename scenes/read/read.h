// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <string>
#include <string_view>

namespace tandem {

/// Parses the bytes of one mesh file, also of one that gzip has compressed. The content determines the
/// format, otherwise the suffix of `source`. Does not call complete_mesh. Throws InputError `source:line:
/// what; what to do` (binary: `source: byte N:
/// ...`).
Mesh parse_mesh(std::string_view bytes, const std::string& source, const MeshReading& reading = {});

/// Reads a mesh file, as read_mesh() does, without completing the mesh: only vertices and tetrahedra.
Mesh parse_file(const std::string& path, const MeshReading& reading = {});

/// Parses a TetGen pair, numbered from 0 or 1. Does not call complete_mesh. Throws InputError like
/// parse_mesh.
Mesh parse_tetgen(std::string_view node, const std::string& node_source, std::string_view ele,
                  const std::string& ele_source, const MeshReading& reading = {});

} // namespace tandem
