// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "algorithms/hierarchy/order.h"
#include "scenes/scene.h"

#include <cstddef>
#include <vector>

namespace tandem {

/// Appends 4 reals a vertex (the fourth is padding) in the ordered mesh's numbering, rounded once to the
/// geometry's precision.
void pack_vertices(std::vector<std::byte>& out, const Geometry& geometry, const OrderedMesh& mesh,
                   const std::vector<Eigen::Vector3d>& vertices);

/// The same rows to `out`, which has room for them.
void write_vertices(std::byte* out, const Geometry& geometry, const OrderedMesh& mesh,
                    const std::vector<Eigen::Vector3d>& vertices);

/// Appends 12 reals a pose: the rows of the rotation matrix, each followed by its component of the
/// translation. The quaternion is normalised and the matrix made in double, then rounded once. With placement
/// = exact 4 more: `drift`, the body's drift_bound, and padding.
void pack_pose(std::vector<std::byte>& out, const Geometry& geometry, const Pose& pose,
               const std::array<double, 3>& drift);

/// The same 12 numbers before rounding.
std::array<double, 12> pose_rows(const Pose& pose);

} // namespace tandem
