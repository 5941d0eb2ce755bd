// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <span>

namespace tandem::simulate {

/// The point nearest to `direction` among all sums of `rays` (of length 1) with weights >= 0.
Eigen::Vector3d nearest_in_cone(std::span<const Eigen::Vector3d> rays, const Eigen::Vector3d& direction);

/// Distance of `direction` (of length 1) from the farther of two cones; 0 inside both. A cone without rays
/// contains every direction.
double outside(std::span<const Eigen::Vector3d> one, std::span<const Eigen::Vector3d> other,
               const Eigen::Vector3d& direction);

/// A direction of length 1 in both cones near `direction`, or one near both when the cones are disjoint. Uses
/// alternating projections (von Neumann 1950).
Eigen::Vector3d moved_into_cones(std::span<const Eigen::Vector3d> one, std::span<const Eigen::Vector3d> other,
                                 const Eigen::Vector3d& direction);

} // namespace tandem::simulate
