// SPDX-License-Identifier: MIT
#include "algorithms/bodies/arc.h"

#include <array>
#include <cmath>

namespace tandem {

namespace {

/// Bound on the error of the distance between two normalised quaternions.
constexpr double normalisation_error = 0x1p-50;
/// Factor for all later roundings, in float too.
constexpr double slack = 1 + 0x1p-20;

std::array<double, 4> unit(const Eigen::Quaterniond& q) {
    const double length = std::sqrt((q.w() * q.w() + q.x() * q.x()) + (q.y() * q.y() + q.z() * q.z()));
    return {q.w() / length, q.x() / length, q.y() / length, q.z() / length};
}

} // namespace

/// For unit quaternions p and q with p.q >= 0, cos(theta / 2) = p.q = 1 - |q - p|^2 / 2. The difference has
/// no cancellation for small angles.
double arc_between(const Pose& from, const Pose& to) {
    const auto p = unit(from.rotation), q = unit(to.rotation);
    const double dot = (p[0] * q[0] + p[1] * q[1]) + (p[2] * q[2] + p[3] * q[3]);
    const double sign = dot < 0 ? -1 : 1; // q and -q are one rotation
    const double w = q[0] - sign * p[0], x = q[1] - sign * p[1];
    const double y = q[2] - sign * p[2], z = q[3] - sign * p[3];
    const double square = (w * w + x * x) + (y * y + z * z);
    if (!(square > 0)) return 0;
    const double distance = std::sqrt(square) + normalisation_error;
    return 0.5 * distance * distance * slack;
}

} // namespace tandem
