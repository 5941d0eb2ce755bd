// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

namespace tandem {

/// A ball about the centre of the bounding box of some points.
struct Ball {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double radius = 0;
};

/// The ball that contains the points; NaN without points.
Ball ball_around(const std::vector<Eigen::Vector3d>& points);

/// The centre of that ball.
Eigen::Vector3d box_centre(const std::vector<Eigen::Vector3d>& points);

} // namespace tandem
