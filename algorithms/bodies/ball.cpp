// SPDX-License-Identifier: MIT
#include "algorithms/bodies/ball.h"

#include <algorithm>
#include <limits>

namespace tandem {

Eigen::Vector3d box_centre(const std::vector<Eigen::Vector3d>& points) {
    Eigen::Vector3d lower = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d upper = -lower;
    for (const auto& point : points) {
        lower = lower.cwiseMin(point);
        upper = upper.cwiseMax(point);
    }
    return 0.5 * (lower + upper);
}

Ball ball_around(const std::vector<Eigen::Vector3d>& points) {
    Ball ball{box_centre(points), 0};
    for (const auto& point : points) ball.radius = std::max(ball.radius, (point - ball.centre).stableNorm());
    return ball;
}

} // namespace tandem
