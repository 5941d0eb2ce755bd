// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace tandem {

/// q divided by its length, in a fixed order of operations, because poses must have the same bits on every
/// machine and Eigen may add in another order. q must be finite and not 0. algorithms/bodies/pack_frame.cl
/// has the same operations.
Eigen::Quaterniond unit(const Eigen::Quaterniond& q);

/// The rotation of four numbers w x y z that a user gave, of any length; none if they are not finite or all
/// 0. Every reader of rotations takes this one, so that the same numbers give the same bits everywhere.
std::optional<Eigen::Quaterniond> given_rotation(double w, double x, double y, double z);

} // namespace tandem
