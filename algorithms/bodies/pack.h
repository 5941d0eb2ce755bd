// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "algorithms/orders/order.h"
#include "scenes/scene.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tandem {

/// Appends 4 reals per vertex in the numbering of the ordered mesh, rounded once to the geometry's precision.
/// `fourth`: the fourth real of each vertex, in the order of `vertices`; empty: 0.
void pack_vertices(std::vector<std::byte>& out, const Geometry& geometry, const OrderedMesh& mesh,
                   const std::vector<Eigen::Vector3d>& vertices, std::span<const double> fourth = {});

/// The same, but the fourth real is the vertex's distance from the origin about which the mesh turns, rounded
/// up (swing_of of body.clh). `shift`: the shift (shift.h) of the mesh, whose own origin is at -shift.
void pack_vertices_with_distances(std::vector<std::byte>& out, const Geometry& geometry,
                                  const OrderedMesh& mesh, const std::vector<Eigen::Vector3d>& vertices,
                                  const Eigen::Vector3d& shift);

/// Writes the rows of pack_vertices, with 0 as their fourth real, to `out`, which must be large enough.
void write_vertices(std::byte* out, const Geometry& geometry, const OrderedMesh& mesh,
                    const std::vector<Eigen::Vector3d>& vertices);

/// Appends numbers, rounded to the geometry's precision.
void pack_reals(std::vector<std::byte>& out, const Geometry& geometry, std::span<const double> numbers);

/// Appends the 12 reals of a pose: the rows of the rotation matrix, each followed by its component of the
/// translation. The quaternion is normalised and the matrix computed in double, then rounded once. With
/// placement=exact or motion=linear 4 more reals follow: `drift`, the body's drift_bound, and `arc` (arc.h).
void pack_pose(std::vector<std::byte>& out, const Geometry& geometry, const Pose& pose,
               const std::array<double, 3>& drift, double arc = 0);

/// The same 12 numbers before rounding.
std::array<double, 12> pose_rows(const Pose& pose);

} // namespace tandem
