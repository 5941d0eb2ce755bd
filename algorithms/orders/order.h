// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "algorithms/parameters/parameter.h"
#include "scenes/scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tandem {

/// The 63-bit Morton code of a point on the lattice of 2^21 cells per axis: bit 3i + 2 is bit i of x, 3i + 1
/// of y, 3i of z.
std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z);

/// The 63-bit index of the same cell on the three-dimensional Hilbert curve, on which successive cells share
/// a face. J. Skilling, "Programming the Hilbert curve", AIP Conference Proceedings 707, 2004.
std::uint64_t hilbert_code(std::uint32_t x, std::uint32_t y, std::uint32_t z);

/// Positions of points along the Z-curve: order[i] is the point at position i. Ties keep the input order. All
/// axes have one cell size, so cells are cubes. Coplanar and coincident points are valid. A NaN coordinate
/// belongs to the first cell.
std::vector<std::uint32_t> morton_order(const std::vector<Eigen::Vector3d>& points);

/// The same for a mesh's tetrahedra by their centroids (paper, section 3.1).
std::vector<std::uint32_t> morton_order(const Mesh& mesh);

/// Positions along the Hilbert curve, with the same cells and ties.
std::vector<std::uint32_t> hilbert_order(const std::vector<Eigen::Vector3d>& points);
std::vector<std::uint32_t> hilbert_order(const Mesh& mesh);

/// Centroids of a mesh's tetrahedra. They may overflow where coordinates are near the largest numbers.
std::vector<Eigen::Vector3d> centroids(const Mesh& mesh);

/// The tetrahedra of a mesh that a session walks; merged duplicates never.
enum class Walked {
    all,
    boundary,   ///< those with boundary faces; all if none of a mesh has them, since no tree is empty
    by_pressure ///< all, but no pairs without a common pressure
};

/// The tetrahedra that sessions with these settings walk. With output=contacts, a rule whose contacts need
/// boundary faces of both tetrahedra leaves out the others. residency=published walks everything.
/// by_pressure: pressure_slab=on.
Walked walked_of(const Settings& settings);

/// Numbers of the walked tetrahedra, ascending.
std::vector<std::uint32_t> walked_tetrahedra(const Mesh& mesh, Walked walked);
std::size_t count_walked(const Mesh& mesh, Walked walked);
/// Summed over the bodies of a scene.
std::size_t count_walked(const Scene& scene, Walked walked);

/// How a mesh is laid out on a device.
struct MeshOrder {
    Builder builder = Builder::morton;
    Walked walked = Walked::all;
};

/// A mesh in device layout: tetrahedra in a builder's order, vertices renumbered by first use.
struct OrderedMesh {
    std::vector<std::uint32_t> tetrahedra; ///< 4 vertex numbers each, in the new numbering
    std::vector<std::uint32_t> joined;   ///< the same by Mesh::welded, for common vertices; empty: not welded
    std::vector<std::uint32_t> ids;      ///< position -> tetrahedron in input order; walked ones only
    std::vector<std::uint32_t> vertices; ///< new vertex number -> vertex in input order
    std::vector<std::uint32_t> numbers;  ///< vertex in input order -> new number, or `unused`
    std::vector<std::uint8_t> boundary;  ///< as Mesh::boundary, by position

    /// Numbers that are equal where corners are one vertex of the topology; by position, 4 each.
    const std::vector<std::uint32_t>& topology() const { return joined.empty() ? tetrahedra : joined; }

    static constexpr std::uint32_t unused = 0xffffffff; ///< number of a vertex without walked tetrahedra
};

/// Orders a mesh that complete_mesh has checked.
OrderedMesh ordered(const Mesh& mesh, MeshOrder order = {});

} // namespace tandem
