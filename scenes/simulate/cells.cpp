// SPDX-License-Identifier: MIT
#include "scenes/simulate/cells.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tandem::simulate {

namespace {

/// Cells are wider than the radius, so that the neighbourhood of most points lies in one cell.
constexpr double radii_per_cell = 8;
/// Offset of the grid in cell widths. Points often have round coordinates, which must not be near cell walls.
constexpr double shift = 0.381966;

} // namespace

void PointGrid::reset(const Eigen::Vector3d& origin, double radius, std::size_t count) {
    radius_ = radius;
    width_ = radii_per_cell * radius;
    origin_ = origin - Eigen::Vector3d::Constant(shift * width_);
    heads_.assign(std::bit_ceil(2 * count), none);
    entries_.clear();
}

void PointGrid::insert(const Eigen::Vector3d& point, std::uint32_t value) {
    auto& head = heads_[slot(cell(point, 0))];
    entries_.push_back({value, head});
    head = static_cast<std::uint32_t>(entries_.size() - 1);
}

PointGrid::GridCell PointGrid::cell(const Eigen::Vector3d& point, double offset) const {
    constexpr double most = 0x1p60;
    GridCell result;
    for (int axis = 0; axis < 3; ++axis) {
        const double index = std::floor((point[axis] - origin_[axis] + offset) / width_);
        result[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::clamp(index, -most, most));
    }
    return result;
}

std::size_t PointGrid::slot(const GridCell& cell) const {
    std::uint64_t hash = 0;
    for (const auto part : cell) {
        hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash) & (heads_.size() - 1);
}

} // namespace tandem::simulate
