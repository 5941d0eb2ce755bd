// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tandem {

using Tetrahedron = std::array<std::uint32_t, 4>;

/// Vertices and tetrahedra in mesh coordinates. Tetrahedra keep the order of their source, which numbers them
/// in dumps. After complete_mesh every index is in range and every coordinate is finite.
struct Mesh {
    std::string name;                      ///< for messages; from read_mesh: the file's name without suffix
    std::vector<Eigen::Vector3d> vertices; ///< x, y, z, in the scene's unit of length
    std::vector<Tetrahedron> tetrahedra;   ///< four indices into `vertices` each
    /// Bit i of boundary[t]: the face of tetrahedron t opposite its corner i belongs to no other tetrahedron.
    std::vector<std::uint8_t> boundary;
    std::size_t inverted = 0;   ///< number of tetrahedra with negative volume; they are kept
    std::size_t degenerate = 0; ///< number of tetrahedra with zero volume; they are kept
};

/// Checks indices and coordinates (throws InputError naming `source`), then fills boundary, inverted and
/// degenerate. Volume signs come from det[b-a, c-a, d-a] in double.
void complete_mesh(Mesh& mesh, const std::string& source);

/// Counts inverted and degenerate tetrahedra; indices must be in range.
void count_flawed(Mesh& mesh);

/// Reads a tetrahedral mesh; content and suffix determine the format: Gmsh .msh 2.2 and 4.1 (ASCII and
/// binary), Medit .mesh, TetGen .node/.ele (either file names the pair), legacy .vtk and .vtu. Returns a
/// completed mesh; throws InputError with file:line.
Mesh read_mesh(const std::string& path);

/// Volume of the union of non-overlapping tetrahedra: the sum of |det|/6.
double volume(const Mesh& mesh);

} // namespace tandem
