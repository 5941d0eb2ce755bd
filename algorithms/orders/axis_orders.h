// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tandem {

/// Points sorted along x, y and z. Cutting a range keeps each part sorted along all three axes, in time
/// linear in the range's size. Points with equal coordinates are ordered by number, so that every machine
/// produces the same order. A NaN coordinate counts as zero.
class AxisOrders {
public:
    /// A range of consecutive positions.
    struct ItemRange {
        std::size_t first = 0, end = 0;

        std::size_t size() const { return end - first; }
    };

    explicit AxisOrders(const std::vector<Eigen::Vector3d>& points);

    std::size_t size() const { return sorted_[0].size(); }
    /// Maps positions to points, sorted along `axis` within every range.
    const std::vector<std::uint32_t>& along(std::size_t axis) const { return sorted_[axis]; }
    /// Moves the points before position `split` along `axis` to the front of the range along all axes.
    void cut(ItemRange range, std::size_t axis, std::size_t split);

private:
    std::array<std::vector<std::uint32_t>, 3> sorted_;
    std::vector<std::uint8_t> is_left_;
    std::vector<std::uint32_t> moved_;
};

/// Run length for cutting a range of `size` items, so that trees whose nodes are runs of 32, 32^2, ... get
/// full runs. Above 32 items: the power of 32 that leaves 2 to 32 runs. Up to 32 items: half the width of the
/// perfect binary tree over them.
std::size_t run_of(std::size_t size);

} // namespace tandem
