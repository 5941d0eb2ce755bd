// SPDX-License-Identifier: MIT
#include "base/quaternion.h"

#include <cmath>

namespace tandem {

namespace {

/// A power of two that keeps squares of the numbers from overflow and underflow. It is 1, which changes no
/// bits, unless they are extreme.
double scale_of(const Eigen::Quaterniond& q) {
    const double largest = q.coeffs().cwiseAbs().maxCoeff();
    return largest > 0x1p498 ? 0x1p-600 : largest < 0x1p-498 ? 0x1p600 : 1;
}

} // namespace

Eigen::Quaterniond unit(const Eigen::Quaterniond& q) {
    const double scale = scale_of(q);
    const double w = q.w() * scale, x = q.x() * scale, y = q.y() * scale, z = q.z() * scale;
    const double length = std::sqrt((w * w + x * x) + (y * y + z * z));
    return {w / length, x / length, y / length, z / length};
}

std::optional<Eigen::Quaterniond> given_rotation(double w, double x, double y, double z) {
    const Eigen::Quaterniond q(w, x, y, z);
    if (!q.coeffs().allFinite() || q.coeffs().isZero(0)) return std::nullopt;
    return unit(q);
}

} // namespace tandem
