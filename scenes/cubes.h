// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem {

/// The six tetrahedra of a cube around the diagonal from corner 0 to 7. Bits 0, 1 and 2 of a corner's number
/// are x, y and z. They are the paths along edges between these corners; the odd ones have their middle
/// corners swapped, so that none is inverted. Opposite faces have the same diagonal: rows of cubes conform.
inline constexpr std::array<Tetrahedron, 6> tetrahedra_of_cube = {
    {{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 3, 2, 7}, {0, 6, 4, 7}, {0, 5, 1, 7}}};

/// The numbers of cubes along x, y and z.
using CubeCounts = std::array<std::uint64_t, 3>;

/// A grid of cubes with an edge of 1 and its first corner at the origin. Its vertices follow each other along
/// x, then y, then z, and it is not yet complete: the caller moves them and calls complete_mesh(). Throws
/// InputError when it exceeds memory.
Mesh cubes(const std::string& name, const CubeCounts& counts);

/// A box about the origin, cut into equal parts along its edges. Complete; throws as cubes().
Mesh box_of_cubes(const std::string& name, const Eigen::Vector3d& size, const CubeCounts& counts);

/// An ellipsoid about the origin of 6 cells^3 tetrahedra: the shells of a cube of cells^3 are moved to
/// spheres, then stretched to these radii. Complete; throws as cubes().
Mesh ball_of_cubes(const std::string& name, const Eigen::Vector3d& radii, std::uint64_t cells);

} // namespace tandem
