// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tandem {

/// The 63-bit Morton code of a point on the lattice of 2^21 cells per axis: bit 3i + 2 is bit i of x, 3i + 1
/// of y, 3i of z.
std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z);

/// Positions of points along the Z-curve: order[i] is the point at position i. Ties keep the input order. One
/// cell size for all axes, so that cells are cubes; points on one plane or in one place are fine.
std::vector<std::uint32_t> morton_order(const std::vector<Eigen::Vector3d>& points);

/// The same for the mesh's tetrahedra by their centroids (paper, section 3.1).
std::vector<std::uint32_t> morton_order(const Mesh& mesh);

/// Tetrahedra per chunk, L of equations (1)-(3): two hierarchies of nodes of 4k + 24 bytes in `bytes`.
/// Equation (2) is taken with the lower power of two, as the paper's own chunk counts require. At least 2.
std::uint32_t leaves_of_chunk_bytes(std::uint64_t bytes, int k);

/// One level: its first node slot in the body, how many items it is over, and in how many chunks.
struct Level {
    std::uint32_t slot = 0;
    std::uint32_t items = 0;
    std::uint32_t chunks = 0;
};

/// Level 0 over the tetrahedra, each further one over the chunk roots of the one below, until at most
/// `leaves` chunks are left (Algorithm 1). A level of n items takes 2n slots.
std::vector<Level> chunk_levels(std::uint32_t tetrahedra, std::uint32_t leaves);

std::uint32_t slot_count(std::span<const Level> levels);

/// The smallest e with 2^e >= n; n >= 1.
std::uint32_t ceil_log2(std::uint32_t n);

/// A mesh as the device wants it: tetrahedra in Morton order, vertices renumbered by first use.
struct OrderedMesh {
    std::vector<std::uint32_t> tetrahedra; ///< 4 vertex numbers each, new numbering
    std::vector<std::uint32_t> ids;        ///< position -> tetrahedron in input order
    std::vector<std::uint32_t> vertices;   ///< new vertex number -> vertex in input order
    std::vector<std::uint8_t> boundary;    ///< as Mesh::boundary, by position
};

OrderedMesh ordered(const Mesh& mesh);

} // namespace tandem
