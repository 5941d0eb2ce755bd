// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/sah_order.h"

#include "algorithms/hierarchy/axis_orders.h"

#include <algorithm>
#include <limits>

namespace tandem {

namespace {

struct Box {
    Eigen::Vector3d lower = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d upper = -lower;

    void add(const Box& other) {
        lower = lower.cwiseMin(other.lower);
        upper = upper.cwiseMax(other.upper);
    }
    /// Half of the surface area.
    double area() const {
        const Eigen::Vector3d side = upper - lower;
        return (side.x() * side.y() + side.y() * side.z()) + side.z() * side.x();
    }
};

class Splitter {
public:
    explicit Splitter(const Mesh& mesh);

    std::vector<std::uint32_t> order();

private:
    using ItemRange = AxisOrders::ItemRange;
    struct Cut {
        double cost = std::numeric_limits<double>::infinity();
        std::size_t axis = 0, split = 0; ///< first position of the right part
    };

    /// Updates `best` with the cheapest cut along an axis.
    void evaluate_axis(std::size_t axis, ItemRange range, std::size_t unit, Cut& best);

    std::vector<Box> boxes_;
    AxisOrders axes_;
    std::vector<Box> right_; ///< by unit: union of the boxes from this unit to the end
};

std::vector<Box> boxes_of(const Mesh& mesh) {
    std::vector<Box> boxes(mesh.tetrahedra.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        for (const auto vertex : mesh.tetrahedra[i]) {
            const auto& at = mesh.vertices[vertex];
            boxes[i].add({at, at});
        }
    }
    return boxes;
}

std::vector<Eigen::Vector3d> centres_of(const std::vector<Box>& boxes) {
    std::vector<Eigen::Vector3d> centres(boxes.size());
    std::transform(boxes.begin(), boxes.end(), centres.begin(),
                   [](const Box& box) { return Eigen::Vector3d(box.lower + 0.5 * (box.upper - box.lower)); });
    return centres;
}

Splitter::Splitter(const Mesh& mesh) : boxes_(boxes_of(mesh)), axes_(centres_of(boxes_)) {}

void Splitter::evaluate_axis(std::size_t axis, ItemRange range, std::size_t unit, Cut& best) {
    const auto& sorted = axes_.along(axis);
    const auto units = (range.size() + unit - 1) / unit;
    right_.assign(units, {});
    Box all;
    for (auto u = units; u-- > 1;) {
        const auto end = std::min(range.first + (u + 1) * unit, range.end);
        for (auto i = range.first + u * unit; i < end; ++i) all.add(boxes_[sorted[i]]);
        right_[u] = all;
    }
    Box left;
    for (std::size_t u = 1; u < units; ++u) {
        const auto split = range.first + u * unit;
        for (auto i = split - unit; i < split; ++i) left.add(boxes_[sorted[i]]);
        const auto cost = left.area() * static_cast<double>(split - range.first)
                          + right_[u].area() * static_cast<double>(range.end - split);
        if (cost < best.cost || best.split == 0) best = {cost, axis, split};
    }
}

std::vector<std::uint32_t> Splitter::order() {
    std::vector<ItemRange> todo{{0, boxes_.size()}};
    while (!todo.empty()) {
        const auto range = todo.back();
        todo.pop_back();
        if (range.size() < 2) continue;
        Cut cut;
        for (std::size_t axis = 0; axis < 3; ++axis) evaluate_axis(axis, range, run_of(range.size()), cut);
        axes_.cut(range, cut.axis, cut.split);
        todo.push_back({cut.split, range.end});
        todo.push_back({range.first, cut.split});
    }
    return axes_.along(0);
}

} // namespace

std::vector<std::uint32_t> sah_order(const Mesh& mesh) { return Splitter(mesh).order(); }

} // namespace tandem
