// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/scene.h"

#include <array>
#include <span>

namespace tandem {

/// Bound on the error from underflow between a vertex and a slab.
double underflow(Precision precision);

/// Largest distance of a vertex of a mesh from the origin that the mesh had before its shift (shift.h) was
/// subtracted; correct also if squares of coordinates underflow.
double reach_of(std::span<const Eigen::Vector3d> vertices,
                const Eigen::Vector3d& shift = Eigen::Vector3d::Zero());

/// Bound by axis on |x^ - x| for every vertex of a rigid body. x is the scene's vertex, transformed exactly
/// by the pose; x^ is the result of body.clh in the cell's precision. `reach`: reach_of the mesh. Rounded so
/// that directions.clh may add three bounds in that precision. Proof: bounds/README.md, theorem 5 (Higham
/// 2002, 3.1 and 3.5). The norm of the pose's quaternion must be between 2^-400 and 2^400. For a centred mesh
/// `pose` is the shifted() one, and `reach` that of the centred vertices.
std::array<double, 3> drift_bound(const Pose& pose, double reach, Precision precision,
                                  const Eigen::Vector3d& shift = Eigen::Vector3d::Zero());

/// The same for a deformable body. Its only error is the rounding of world vertices to the cell's precision.
std::array<double, 3> drift_bound(std::span<const Eigen::Vector3d> world, Precision precision);

} // namespace tandem
