// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <string>
#include <string_view>

/// One parser per format. Each throws InputError; the caller checks for an empty mesh. They fill
/// Mesh::findings with the cells that they leave out or reduce.
namespace tandem::read {

Mesh parse_gmsh(std::string_view bytes, const std::string& source, const MeshReading& reading);
Mesh parse_medit(std::string_view bytes, const std::string& source, const MeshReading& reading);
Mesh parse_veg(std::string_view bytes, const std::string& source, const MeshReading& reading);
Mesh parse_vtk(std::string_view bytes, const std::string& source, const MeshReading& reading);
Mesh parse_vtu(std::string_view bytes, const std::string& source, const MeshReading& reading);

/// The remedies of a refusal of tetrahedra of higher order, and of other volume cells.
inline constexpr std::string_view corners_remedy =
    "give --corners to read them by their corners, or convert to linear tetrahedra";
inline constexpr std::string_view only_remedy =
    "split them into linear tetrahedra, or give --only-tetrahedra to leave them out";

/// The name of a pressure field among the data of points and nodes.
inline constexpr std::string_view pressure_name = "pressure";

/// Throws InputError when there is no tetrahedron.
void require_tetrahedra(const Mesh& mesh, const std::string& source);

} // namespace tandem::read
