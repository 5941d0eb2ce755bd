// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <string>
#include <string_view>

/// One parser per format. Each throws InputError; the caller checks for an empty mesh.
namespace tandem::read {

Mesh parse_gmsh(std::string_view bytes, const std::string& source);
Mesh parse_medit(std::string_view bytes, const std::string& source);
Mesh parse_veg(std::string_view bytes, const std::string& source);
Mesh parse_vtk(std::string_view bytes, const std::string& source);
Mesh parse_vtu(std::string_view bytes, const std::string& source);

/// Throws InputError when there is no tetrahedron.
void require_tetrahedra(const Mesh& mesh, const std::string& source);

} // namespace tandem::read
