// SPDX-License-Identifier: MIT
#include "algorithms/orders/median_order.h"

#include "algorithms/orders/axis_orders.h"
#include "algorithms/orders/order.h"

namespace tandem {

namespace {

/// Infinite sides, from coordinates near the largest numbers, count as equally long. A side between equal
/// infinities is NaN and never the longest.
std::size_t longest_axis(const AxisOrders& axes, const std::vector<Eigen::Vector3d>& points,
                         AxisOrders::ItemRange range) {
    std::size_t longest = 0;
    double most = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto& sorted = axes.along(axis);
        const auto at = [&](std::size_t i) { return points[sorted[i]][static_cast<Eigen::Index>(axis)]; };
        const double side = at(range.end - 1) - at(range.first);
        if (!(side > most)) continue;
        most = side;
        longest = axis;
    }
    return longest;
}

} // namespace

std::vector<std::uint32_t> median_order(const Mesh& mesh) {
    const auto points = centroids(mesh);
    AxisOrders axes(points);
    std::vector<AxisOrders::ItemRange> todo{{0, points.size()}};
    while (!todo.empty()) {
        const auto range = todo.back();
        todo.pop_back();
        if (range.size() < 2) continue;
        const auto run = run_of(range.size());
        const auto split = range.first + (range.size() + run) / (2 * run) * run;
        axes.cut(range, longest_axis(axes, points, range), split);
        todo.push_back({split, range.end});
        todo.push_back({range.first, split});
    }
    return axes.along(0);
}

} // namespace tandem
