// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <span>

namespace tandem::simulate {

/// The point nearest to `direction` of all sums of `rays` (of length 1) with weights of at least 0.
Eigen::Vector3d nearest_in_cone(std::span<const Eigen::Vector3d> rays, const Eigen::Vector3d& direction);

/// How far `direction` (of length 1) is from the farther of two cones; 0 inside of both. A cone without rays
/// holds every direction.
double outside(std::span<const Eigen::Vector3d> one, std::span<const Eigen::Vector3d> other,
               const Eigen::Vector3d& direction);

/// A direction of length 1 in both cones near `direction`; where they have none in common, one that is near
/// both. By projections onto one and the other in turn (von Neumann 1950).
Eigen::Vector3d brought_into(std::span<const Eigen::Vector3d> one, std::span<const Eigen::Vector3d> other,
                             const Eigen::Vector3d& direction);

} // namespace tandem::simulate
