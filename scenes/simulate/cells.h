// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace tandem::simulate {

/// A hashed grid of the points of one body pair, to find neighbours within `radius`.
class PointGrid {
public:
    /// Empties the grid and sets its capacity to `count` points.
    void reset(const Eigen::Vector3d& origin, double radius, std::size_t count);
    void insert(const Eigen::Vector3d& point, std::uint32_t value);

    /// The smallest value in cells within `radius` of `point` for which accept(value) is true, or `none`.
    template<class Accept>
    std::uint32_t least(const Eigen::Vector3d& point, Accept accept) const {
        const auto low = cell(point, -radius_), high = cell(point, radius_);
        std::uint32_t best = none;
        for (auto x = low[0]; x <= high[0]; ++x)
            for (auto y = low[1]; y <= high[1]; ++y)
                for (auto z = low[2]; z <= high[2]; ++z)
                    for (auto i = heads_[slot({x, y, z})]; i != none; i = entries_[i].next)
                        if (entries_[i].value < best && accept(entries_[i].value)) best = entries_[i].value;
        return best;
    }

    static constexpr std::uint32_t none = UINT32_MAX;

private:
    using GridCell = std::array<std::int64_t, 3>;
    struct Entry {
        std::uint32_t value, next;
    };

    GridCell cell(const Eigen::Vector3d& point, double offset) const;
    /// Different cells may share a slot. Callers compare distances, so that a collision costs only time.
    std::size_t slot(const GridCell& cell) const;

    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
    double radius_ = 0, width_ = 1;
    std::vector<std::uint32_t> heads_;
    std::vector<Entry> entries_;
};

} // namespace tandem::simulate
