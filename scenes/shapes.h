// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem {

/// The nearest multiple of 2^-18 m in single precision. Below 64 m such numbers and their sums are exact in
/// single precision, so that stacked stones touch exactly.
double on_grid(double length);
/// The nearest length whose half is on_grid.
double halved_on_grid(double length);

/// The functions below return complete meshes about the origin, with coordinates on_grid. They throw
/// InputError when a tetrahedron is flat or inverted.

/// Box of 9 vertices and 12 tetrahedra that share the centre.
Mesh box(const Eigen::Vector3d& size);

/// Hexahedron of 8 vertices and 6 tetrahedra around the diagonal from corner 0 to 7. Bits 0, 1 and 2 of a
/// corner's number are its sides along three right-handed directions; faces must be plane. Opposite faces
/// have the same diagonal, so that rows of hexahedra conform.
Mesh hexahedron(const std::array<Eigen::Vector3d, 8>& corners);

/// Sphere of `slices` meridians and `stacks` rows whose tetrahedra share the centre:
/// slices (stacks - 1) + 3 vertices, 2 slices (stacks - 1) tetrahedra.
Mesh sphere(double radius, std::size_t slices, std::size_t stacks);

/// Upright prism or frustum of `slices` sides whose tetrahedra share the centre:
/// 2 slices + 3 vertices, 4 slices tetrahedra.
Mesh drum(std::size_t slices, double lower_radius, double upper_radius, double height);

/// The mesh with its coordinates multiplied by `factors`, in single precision.
Mesh scaled(Mesh mesh, const Eigen::Vector3d& factors);

} // namespace tandem
