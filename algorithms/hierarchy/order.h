// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "scenes/mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tandem {

/// The 63-bit Morton code of a point on the lattice of 2^21 cells per axis: bit 3i + 2 is bit i of x, 3i + 1
/// of y, 3i of z.
std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z);

/// The place of the same cell on the three-dimensional Hilbert curve, of 63 bits: one cell to the next shares
/// a face with it. J. Skilling, "Programming the Hilbert curve", AIP Conference Proceedings 707, 2004.
std::uint64_t hilbert_code(std::uint32_t x, std::uint32_t y, std::uint32_t z);

/// Positions of points along the Z-curve: order[i] is the point at position i. Ties keep the input order. One
/// cell size for all axes, so that cells are cubes; points on one plane or in one place are fine, and a
/// coordinate that is no number is in the first cell.
std::vector<std::uint32_t> morton_order(const std::vector<Eigen::Vector3d>& points);

/// The same for the mesh's tetrahedra by their centroids (paper, section 3.1).
std::vector<std::uint32_t> morton_order(const Mesh& mesh);

/// Along Hilbert's curve, with the same cells and ties.
std::vector<std::uint32_t> hilbert_order(const std::vector<Eigen::Vector3d>& points);
std::vector<std::uint32_t> hilbert_order(const Mesh& mesh);

/// Centroids of the mesh's tetrahedra; not finite where coordinates are near the largest numbers.
std::vector<Eigen::Vector3d> centroids(const Mesh& mesh);

/// A mesh as the device wants it: tetrahedra in a builder's order, vertices renumbered by first use.
struct OrderedMesh {
    std::vector<std::uint32_t> tetrahedra; ///< 4 vertex numbers each, new numbering
    std::vector<std::uint32_t> ids;        ///< position -> tetrahedron in input order
    std::vector<std::uint32_t> vertices;   ///< new vertex number -> vertex in input order
    std::vector<std::uint32_t> numbers;    ///< vertex in input order -> new number, or `unused`
    std::vector<std::uint8_t> boundary;    ///< as Mesh::boundary, by position

    static constexpr std::uint32_t unused = 0xffffffff; ///< the number of a vertex of no tetrahedron
};

/// Of a complete mesh.
OrderedMesh ordered(const Mesh& mesh, Builder builder = Builder::morton);

} // namespace tandem
