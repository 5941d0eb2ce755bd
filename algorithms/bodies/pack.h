// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "algorithms/hierarchy/order.h"
#include "scenes/scene.h"

#include <cstddef>
#include <vector>

namespace tandem {

/// Appends 4 reals per vertex (the fourth is padding) in the numbering of the ordered mesh, rounded once to
/// the geometry's precision.
void pack_vertices(std::vector<std::byte>& out, const Geometry& geometry, const OrderedMesh& mesh,
                   const std::vector<Eigen::Vector3d>& vertices);

/// Writes the same rows to `out`, which must be large enough.
void write_vertices(std::byte* out, const Geometry& geometry, const OrderedMesh& mesh,
                    const std::vector<Eigen::Vector3d>& vertices);

/// Appends the 12 reals of a pose: the rows of the rotation matrix, each followed by its component of the
/// translation. The quaternion is normalised and the matrix computed in double, then rounded once. With
/// placement=exact 4 more reals follow: `drift`, the body's drift_bound, and padding.
void pack_pose(std::vector<std::byte>& out, const Geometry& geometry, const Pose& pose,
               const std::array<double, 3>& drift);

/// The same 12 numbers before rounding.
std::array<double, 12> pose_rows(const Pose& pose);

} // namespace tandem
