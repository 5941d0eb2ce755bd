// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <vector>

namespace tandem::exporting {

/// Quantises points in a box to 16 bits a coordinate, which is finer than the pixels of a screen.
class Quantised {
public:
    explicit Quantised(const Eigen::AlignedBox3d& box)
        : lower_(box.isEmpty() ? Eigen::Vector3d::Zero() : box.min()),
          size_(box.isEmpty() ? Eigen::Vector3d::Ones() : Eigen::Vector3d(box.sizes())) {}

    const Eigen::Vector3d& lower() const { return lower_; }
    const Eigen::Vector3d& size() const { return size_; }

    /// Appends the three coordinates of a point.
    void add(const Eigen::Vector3d& point, std::vector<std::uint16_t>& numbers) const {
        for (int axis = 0; axis < 3; ++axis) {
            const double fraction = size_[axis] > 0 ? (point[axis] - lower_[axis]) / size_[axis] : 0;
            numbers.push_back(static_cast<std::uint16_t>(std::lround(fraction * 65535)));
        }
    }

private:
    Eigen::Vector3d lower_, size_;
};

} // namespace tandem::exporting
