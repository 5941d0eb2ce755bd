// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem {

/// The nearest multiple of 2^-18 m, in single precision: below 64 m such numbers and their sums are exact in
/// single precision, so that stones stacked on each other touch exactly.
double on_grid(double length);
/// As on_grid, and so is its half.
double halved_on_grid(double length);

/// Complete meshes about the origin, with coordinates on_grid. Throw InputError when a tetrahedron would be
/// flat or inverted in them.

/// 9 vertices, 12 tetrahedra from the centre.
Mesh box(const Eigen::Vector3d& size);

/// 8 vertices, 6 tetrahedra around the diagonal from corner 0 to 7. Bits 0, 1 and 2 of a corner's number are
/// its side along three right-handed directions; faces must be plane. Faces that differ in one bit only are
/// cut alike, so that rows of hexahedra conform.
Mesh hexahedron(const std::array<Eigen::Vector3d, 8>& corners);

/// Sphere of `slices` meridians and `stacks` rows, tetrahedra from the centre:
/// slices (stacks - 1) + 3 vertices, 2 slices (stacks - 1) tetrahedra.
Mesh sphere(double radius, std::size_t slices, std::size_t stacks);

/// Upright prism or frustum of `slices` sides, tetrahedra from the centre:
/// 2 slices + 3 vertices, 4 slices tetrahedra.
Mesh drum(std::size_t slices, double lower_radius, double upper_radius, double height);

/// The mesh with its coordinates multiplied, in single precision.
Mesh scaled(Mesh mesh, const Eigen::Vector3d& factors);

} // namespace tandem
