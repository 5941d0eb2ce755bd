// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

namespace tandem {

/// About the middle of the box around some points.
struct Ball {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double radius = 0;
};

/// Of no points it is not a number.
Ball ball_around(const std::vector<Eigen::Vector3d>& points);

/// Its centre alone.
Eigen::Vector3d box_centre(const std::vector<Eigen::Vector3d>& points);

} // namespace tandem
