// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tandem {

/// Points sorted along x, y and z, and kept so within every range of positions that is cut: for orders that
/// cut a mesh again and again, in linear time a cut. Points of equal coordinates stand by number, so that the
/// order of any points is one on every machine; a coordinate that is no number counts as zero.
class AxisOrders {
public:
    /// Consecutive positions.
    struct ItemRange {
        std::size_t first = 0, end = 0;

        std::size_t size() const { return end - first; }
    };

    explicit AxisOrders(const std::vector<Eigen::Vector3d>& points);

    std::size_t size() const { return sorted_[0].size(); }
    /// Position -> point, along an axis within every range.
    const std::vector<std::uint32_t>& along(std::size_t axis) const { return sorted_[axis]; }
    /// Brings those before `place` along `axis` before the others of the range along all axes.
    void cut(ItemRange range, std::size_t axis, std::size_t place);

private:
    std::array<std::vector<std::uint32_t>, 3> sorted_;
    std::vector<std::uint8_t> is_left_;
    std::vector<std::uint32_t> moved_;
};

/// How long the runs are that a range is cut into, so that trees whose nodes are runs of 32, 32^2, ... have
/// whole ones: of more than 32 the longest that leave no more than 32 of them; of fewer half of the perfect
/// tree over them.
std::size_t run_of(std::size_t size);

} // namespace tandem
