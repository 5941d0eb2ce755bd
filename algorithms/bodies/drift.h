// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/scene.h"

#include <array>
#include <span>

namespace tandem {

/// More than all roundings of a vertex below the least normal number lose on its way to a slab.
double underflow(Precision precision);

/// Largest distance of a vertex from the mesh's origin; right also where squares of coordinates underflow.
double reach_of(std::span<const Eigen::Vector3d> vertices);

/// Bounds, by axis, |x^ - x| of every vertex of a rigid body: x where the pose puts the scene's own vertex
/// exactly, x^ what body.clh makes of it in the cell's precision. `reach`: reach_of the mesh. Rounded so that
/// directions.clh may add three of them in that precision. Proof: README.md here, theorem 5 (Higham 2002, 3.1
/// and 3.5); the pose's quaternion must have a norm between 2^-400 and 2^400.
std::array<double, 3> drift_bound(const Pose& pose, double reach, Precision precision);

/// The same for a deformable body, whose world vertices are only rounded to the cell's precision.
std::array<double, 3> drift_bound(std::span<const Eigen::Vector3d> world, Precision precision);

} // namespace tandem
