// SPDX-License-Identifier: MIT
#include "algorithms/orders/axis_orders.h"
#include "backends/lanes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace tandem {

AxisOrders::AxisOrders(const std::vector<Eigen::Vector3d>& points)
    : is_left_(points.size()), moved_(points.size()) {
    std::vector<double> values(points.size());
    for (int axis = 0; axis < 3; ++axis) {
        std::transform(points.begin(), points.end(), values.begin(),
                       [&](const auto& point) { return std::isnan(point[axis]) ? 0 : point[axis]; });
        auto& sorted = sorted_[static_cast<std::size_t>(axis)];
        sorted.resize(points.size());
        std::iota(sorted.begin(), sorted.end(), 0u);
        std::stable_sort(sorted.begin(), sorted.end(), [&](auto a, auto b) { return values[a] < values[b]; });
    }
}

void AxisOrders::cut(ItemRange range, std::size_t axis, std::size_t split) {
    for (auto i = range.first; i < range.end; ++i) is_left_[sorted_[axis][i]] = i < split;
    for (auto& sorted : sorted_) {
        auto left = range.first, right = split;
        for (auto i = range.first; i < range.end; ++i)
            moved_[is_left_[sorted[i]] ? left++ : right++] = sorted[i];
        std::copy(moved_.begin() + static_cast<std::ptrdiff_t>(range.first),
                  moved_.begin() + static_cast<std::ptrdiff_t>(range.end),
                  sorted.begin() + static_cast<std::ptrdiff_t>(range.first));
    }
}

std::size_t run_of(std::size_t size) {
    constexpr std::size_t tile = TANDEM_LANES;
    if (size <= tile) return std::bit_ceil(size) / 2;
    auto run = tile;
    while (size > run * tile) run *= tile;
    return run;
}

} // namespace tandem
