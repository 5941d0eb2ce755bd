// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem {

/// Mass, centre of mass and inertia about it, in the mesh's axes.
struct MassProperties {
    double mass = 0;                                   ///< kg
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero(); ///< kg m^2, about `centre`
};

/// Exact for a mesh of uniform `density` (kg/m^3) whose tetrahedra do not overlap; inverted tetrahedra count
/// with their absolute volume. Closed form of the integrals of x_i x_j over a tetrahedron: Tonon, "Explicit
/// exact formulas for the 3-D tetrahedron inertia tensor in terms of its vertex coordinates", J. Math. Stat.
/// 1(1), 2004. Throws InputError when mass or inertia vanish or are not finite.
MassProperties mass_properties(const Mesh& mesh, double density);

} // namespace tandem
