// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/motion.h"
#include "scenes/simulate/algebra.h"

namespace tandem::simulate {

/// Rotation matrix of a unit quaternion, in a fixed order of operations.
inline Eigen::Matrix3d rotation_matrix(const Eigen::Quaterniond& q) {
    const double xx = q.x() * q.x(), yy = q.y() * q.y(), zz = q.z() * q.z();
    const double xy = q.x() * q.y(), xz = q.x() * q.z(), yz = q.y() * q.z();
    const double wx = q.w() * q.x(), wy = q.w() * q.y(), wz = q.w() * q.z();
    Eigen::Matrix3d m;
    m.row(0) = Eigen::RowVector3d(1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy));
    m.row(1) = Eigen::RowVector3d(2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx));
    m.row(2) = Eigen::RowVector3d(2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy));
    return m;
}

/// `q` rotated by the rotation vector `angle` (radians, world axes).
inline Eigen::Quaterniond turned(const Eigen::Quaterniond& q, const Eigen::Vector3d& angle) {
    const double magnitude = length(angle);
    if (!(magnitude > 0)) return q;
    return unit(product(turn(angle / magnitude, magnitude), q));
}

} // namespace tandem::simulate
