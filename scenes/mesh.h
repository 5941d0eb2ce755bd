// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh_reading.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tandem {

using Tetrahedron = std::array<std::uint32_t, 4>;

/// What a reader found in a mesh, as counts.
struct MeshFindings {
    std::size_t duplicates = 0; ///< tetrahedra with the same four vertices as an earlier one
    std::size_t coincident = 0; ///< vertices at the position of an earlier one; counted in files and arrays
    std::size_t welded = 0;     ///< vertices that MeshReading::weld joins to an earlier one
    std::size_t ghosts = 0;  ///< tetrahedra that the file marks as duplicate or hidden ghost cells; left out
    std::size_t reduced = 0; ///< tetrahedra of higher order, read by their corners
    std::size_t other_cells = 0; ///< volume cells that are not tetrahedra; left out
};

/// Vertices and tetrahedra in mesh coordinates. Tetrahedra keep the order of their source, which numbers them
/// in dumps. After complete_mesh every index is in range and every coordinate is finite.
struct Mesh {
    std::string name;                      ///< for messages; from read_mesh: the file's name without suffix
    std::vector<Eigen::Vector3d> vertices; ///< x, y, z, in the scene's unit of length
    std::vector<Tetrahedron> tetrahedra;   ///< four indices into `vertices` each
    /// Bit i of boundary[t]: the face of tetrahedron t opposite its corner i belongs to no other tetrahedron,
    /// except to duplicates of t. 0 for a merged duplicate.
    std::vector<std::uint8_t> boundary;
    std::size_t inverted = 0;            ///< number of tetrahedra with negative volume; they are kept
    std::size_t degenerate = 0;          ///< number of tetrahedra with zero volume; they are kept
    std::vector<std::uint32_t> merged{}; ///< duplicates that take no part, ascending
    /// By vertex, the first of the vertices that are one for the topology; empty: each is one of its own.
    std::vector<std::uint32_t> welded{};
    /// The pressure at each vertex, in the scene's unit of pressure, finite and not negative; empty: no
    /// field.
    std::vector<double> pressures{};
    MeshFindings findings{};
    /// How complete_mesh connected it. Its pressure is none if the mesh has a field of its own.
    MeshReading reading{};
};

/// The vertex's number in the topology: boundary faces, duplicates and setting self.
inline std::uint32_t joined(const Mesh& mesh, std::uint32_t vertex) {
    return mesh.welded.empty() ? vertex : mesh.welded[vertex];
}

/// The tetrahedron's vertices in the topology.
Tetrahedron joined(const Mesh& mesh, const Tetrahedron& tetrahedron);

/// Whether a tetrahedron is a merged duplicate.
bool is_merged(const Mesh& mesh, std::uint32_t tetrahedron);

/// Checks indices and coordinates (throws InputError naming `source`), then fills all other members but the
/// name and the findings of readers. Volume signs come from det[b-a, c-a, d-a] in double. Throws InputError
/// for duplicates that `reading` rejects, and for an impossible tolerance or modulus. A completed mesh can be
/// completed again with another reading, which replaces a field that the last one made.
void complete_mesh(Mesh& mesh, const std::string& source, const MeshReading& reading = {});

/// One line about duplicates, coincident vertices, cells that were left out and an odd pressure field; empty
/// when there are none. `weld` is how the caller's users ask for welding of equal positions.
std::string findings_text(const Mesh& mesh, std::string_view weld = "--weld 0");

/// Counts inverted and degenerate tetrahedra; indices must be in range.
void count_flawed(Mesh& mesh);

/// Reads a tetrahedral mesh; content and suffix determine the format: Gmsh .msh 1, 2.2, 4.0 and 4.1 (ASCII
/// and binary), Medit .mesh, TetGen .node/.ele (either file names the pair), Vega .veg, legacy .vtk and .vtu,
/// and all of them compressed by gzip. Returns a completed mesh; throws InputError with file:line.
Mesh read_mesh(const std::string& path, const MeshReading& reading = {});

/// Volume of the union of non-overlapping tetrahedra: the sum of |det|/6, without merged duplicates.
double volume(const Mesh& mesh);

} // namespace tandem
