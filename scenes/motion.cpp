// SPDX-License-Identifier: MIT
#include "scenes/motion.h"

#include "base/random.h"

namespace tandem {

Eigen::Quaterniond product(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    return {((a.w() * b.w() - a.x() * b.x()) - a.y() * b.y()) - a.z() * b.z(),
            ((a.w() * b.x() + a.x() * b.w()) + a.y() * b.z()) - a.z() * b.y(),
            ((a.w() * b.y() - a.x() * b.z()) + a.y() * b.w()) + a.z() * b.x(),
            ((a.w() * b.z() + a.x() * b.y()) - a.y() * b.x()) + a.z() * b.w()};
}

Eigen::Vector3d rotated(const Eigen::Quaterniond& q, const Eigen::Vector3d& v) {
    const Eigen::Quaterniond pure(0, v.x(), v.y(), v.z());
    const auto result = product(product(q, pure), Eigen::Quaterniond(q.w(), -q.x(), -q.y(), -q.z()));
    return {result.x(), result.y(), result.z()};
}

Eigen::Quaterniond turn(const Eigen::Vector3d& axis, double angle) {
    const auto half = sine_cosine(0.5 * angle);
    return {half.cosine, half.sine * axis.x(), half.sine * axis.y(), half.sine * axis.z()};
}

} // namespace tandem
