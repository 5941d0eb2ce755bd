// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem {

/// Mass, centre of mass and inertia in mesh axes.
struct MassProperties {
    double mass = 0;                                   ///< kg
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero(); ///< kg m^2, about `centre`
};

/// Mass properties of a mesh of uniform `density` (kg/m^3), exact when its tetrahedra do not overlap.
/// Inverted tetrahedra count with their absolute volume. Closed form of the integrals of x_i x_j over a
/// tetrahedron: Tonon, "Explicit exact formulas for the 3-D tetrahedron inertia tensor in terms of its vertex
/// coordinates", J. Math. Stat. 1(1), 2004. Throws InputError when mass or inertia are zero or not finite.
MassProperties mass_properties(const Mesh& mesh, double density);

} // namespace tandem
