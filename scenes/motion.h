// SPDX-License-Identifier: MIT
#pragma once

#include "base/quaternion.h"
#include "scenes/scene.h"

namespace tandem {

/// Quaternion algebra in a fixed order of operations, since poses must have the same bits on every machine.
/// Eigen may use vector instructions that add in another order.
Eigen::Quaterniond product(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);
/// q v q*, q a unit quaternion.
Eigen::Vector3d rotated(const Eigen::Quaterniond& q, const Eigen::Vector3d& v);
/// Rotation by `angle` radians about a unit axis.
Eigen::Quaterniond turn(const Eigen::Vector3d& axis, double angle);

} // namespace tandem
