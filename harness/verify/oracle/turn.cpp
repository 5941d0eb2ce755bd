// SPDX-License-Identifier: MIT
#include "harness/verify/oracle/turn.h"

#include "scenes/motion.h"

#include <algorithm>
#include <cmath>

namespace tandem::oracle {

namespace {

/// Smaller angles and cosines than this are rounding errors of two normalised quaternions.
constexpr double least = 0x1p-50;

/// Error bound of bend() for a corner at this distance from the mesh's origin: 128 units in the last place
/// cover some 30 roundings. All terms have a factor that is at most the angle.
double bend_error(double distance, double angle) { return 0x1p-46 * distance * angle; }

} // namespace

Turn::Turn(const Pose& from, const Pose& to) : first(unit(from.rotation)) {
    const auto last = unit(to.rotation);
    if (first.coeffs() == last.coeffs() || first.coeffs() == -last.coeffs()) return;
    const auto difference = product(last, first.conjugate());
    const double side = difference.w() < 0 ? -1 : 1;
    const double sine = difference.vec().norm();
    if (sine > 0) axis = side / sine * difference.vec();
    angle = std::max(2 * std::atan2(sine, side * difference.w()), least);
    either = std::fabs(difference.w()) <= least;
}

void Turn::bend(MovingTetra& moving, std::span<const Eigen::Vector3d, 4> corners, bool other_way) const {
    moving.angle = angle;
    if (angle == 0) return;
    const Eigen::Vector3d about = other_way ? -axis : axis;
    for (unsigned i = 0; i < 4; ++i) {
        const Eigen::Vector3d arm = rotated(first, corners[i]);
        const Eigen::Vector3d across = arm - about.dot(arm) * about, along = about.cross(arm);
        moving.across[i] = {across.x(), across.y(), across.z()};
        moving.along[i] = {along.x(), along.y(), along.z()};
        moving.off = std::max(moving.off, bend_error(arm.norm(), angle));
    }
}

double Turn::leaves_chord(std::span<const Eigen::Vector3d> vertices) const {
    double result = 0;
    for (const auto& v : vertices) {
        const double radius = axis.cross(rotated(first, v)).norm();
        result = std::max(result, angle * angle / 8 * radius * (1 + 0x1p-40) + bend_error(v.norm(), angle));
    }
    return result;
}

} // namespace tandem::oracle
