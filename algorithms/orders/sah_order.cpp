// SPDX-License-Identifier: MIT
#include "algorithms/orders/sah_order.h"

#include "algorithms/orders/axis_orders.h"
#include "algorithms/orders/heap.h"

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

    /// The order whose ranges are cut at the cheapest multiple of run_of.
    std::vector<std::uint32_t> order_of_runs();
    /// The order whose ranges are cut at left_leaves.
    std::vector<std::uint32_t> order_of_complete_tree();

private:
    using ItemRange = AxisOrders::ItemRange;
    struct Cut {
        double cost = std::numeric_limits<double>::infinity();
        std::size_t axis = 0, split = 0; ///< first position of the right part
    };

    /// Cuts ranges until they have one item; `cut_of` chooses the cut of a range.
    template<class CutOf>
    std::vector<std::uint32_t> order(const CutOf& cut_of);
    /// The union of the boxes in a range of positions along an axis.
    Box union_of(std::size_t axis, ItemRange range) const;
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

template<class CutOf>
std::vector<std::uint32_t> Splitter::order(const CutOf& cut_of) {
    std::vector<ItemRange> todo{{0, boxes_.size()}};
    while (!todo.empty()) {
        const auto range = todo.back();
        todo.pop_back();
        if (range.size() < 2) continue;
        const Cut cut = cut_of(range);
        axes_.cut(range, cut.axis, cut.split);
        todo.push_back({cut.split, range.end});
        todo.push_back({range.first, cut.split});
    }
    return axes_.along(0);
}

std::vector<std::uint32_t> Splitter::order_of_runs() {
    return order([&](ItemRange range) {
        Cut cut;
        for (std::size_t axis = 0; axis < 3; ++axis) evaluate_axis(axis, range, run_of(range.size()), cut);
        return cut;
    });
}

Box Splitter::union_of(std::size_t axis, ItemRange range) const {
    Box all;
    for (auto i = range.first; i < range.end; ++i) all.add(boxes_[axes_.along(axis)[i]]);
    return all;
}

/// Leaves of the left half of a complete binary tree over `leaves` >= 2.
std::size_t left_leaves(std::size_t leaves) {
    const auto left = heap::first_child(heap::root_node);
    return heap::last_item_below(left, static_cast<std::uint32_t>(leaves)) + 1;
}

std::vector<std::uint32_t> Splitter::order_of_complete_tree() {
    return order([&](ItemRange range) {
        const auto left = left_leaves(range.size());
        const auto split = range.first + left;
        Cut best;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto cost =
                union_of(axis, {range.first, split}).area() * static_cast<double>(left)
                + union_of(axis, {split, range.end}).area() * static_cast<double>(range.size() - left);
            if (cost < best.cost || best.split == 0) best = {cost, axis, split};
        }
        return best;
    });
}

} // namespace

std::vector<std::uint32_t> sah_order(const Mesh& mesh) { return Splitter(mesh).order_of_runs(); }

std::vector<std::uint32_t> balanced_order(const Mesh& mesh) {
    return Splitter(mesh).order_of_complete_tree();
}

} // namespace tandem
