// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/sah_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>

namespace tandem {

namespace {

constexpr std::size_t run = 32; ///< a tile's tetrahedra

struct Box {
    Eigen::Vector3d lower = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d upper = -lower;

    void add(const Box& other) {
        lower = lower.cwiseMin(other.lower);
        upper = upper.cwiseMax(other.upper);
    }
    /// Half of its surface.
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
    struct Range {
        std::size_t first = 0, end = 0;

        std::size_t size() const { return end - first; }
    };
    struct Cut {
        double cost = std::numeric_limits<double>::infinity();
        std::size_t axis = 0, place = 0; ///< the first of the right part
    };

    /// Consider all places along an axis.
    void look_along(std::size_t axis, Range range, std::size_t unit, Cut& best);
    /// Brings those left of the cut before the others, along all axes, without changing their order.
    void divide(Range range, const Cut& cut);

    std::vector<Box> boxes_;
    std::array<std::vector<std::uint32_t>, 3>
        sorted_;             ///< tetrahedra along each axis, within every range cut so far
    std::vector<Box> right_; ///< unions from the end, by unit
    std::vector<std::uint8_t> is_left_;
    std::vector<std::uint32_t> moved_;
};

Splitter::Splitter(const Mesh& mesh)
    : boxes_(mesh.tetrahedra.size()), is_left_(boxes_.size()), moved_(boxes_.size()) {
    std::vector<Eigen::Vector3d> centres(boxes_.size());
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
        for (const auto vertex : mesh.tetrahedra[i]) {
            const auto& at = mesh.vertices[vertex];
            boxes_[i].add({at, at});
        }
        centres[i] = boxes_[i].lower + 0.5 * (boxes_[i].upper - boxes_[i].lower);
    }
    for (int axis = 0; axis < 3; ++axis) {
        auto& sorted = sorted_[static_cast<std::size_t>(axis)];
        sorted.resize(boxes_.size());
        std::iota(sorted.begin(), sorted.end(), 0u);
        std::stable_sort(sorted.begin(), sorted.end(),
                         [&](auto a, auto b) { return centres[a][axis] < centres[b][axis]; });
    }
}

void Splitter::look_along(std::size_t axis, Range range, std::size_t unit, Cut& best) {
    const auto& sorted = sorted_[axis];
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
        const auto place = range.first + u * unit;
        for (auto i = place - unit; i < place; ++i) left.add(boxes_[sorted[i]]);
        const auto cost = left.area() * static_cast<double>(place - range.first)
                          + right_[u].area() * static_cast<double>(range.end - place);
        if (cost < best.cost || best.place == 0) best = {cost, axis, place};
    }
}

void Splitter::divide(Range range, const Cut& cut) {
    for (auto i = range.first; i < range.end; ++i) is_left_[sorted_[cut.axis][i]] = i < cut.place;
    for (auto& sorted : sorted_) {
        auto left = range.first, right = cut.place;
        for (auto i = range.first; i < range.end; ++i)
            moved_[is_left_[sorted[i]] ? left++ : right++] = sorted[i];
        std::copy(moved_.begin() + static_cast<std::ptrdiff_t>(range.first),
                  moved_.begin() + static_cast<std::ptrdiff_t>(range.end),
                  sorted.begin() + static_cast<std::ptrdiff_t>(range.first));
    }
}

/// How long the runs are that a range is cut into: of more than 32 the longest that leave no more than 32 of
/// them.
std::size_t unit_of(std::size_t size) {
    if (size <= run) return std::bit_ceil(size) / 2;
    auto unit = run;
    while (size > unit * run) unit *= run;
    return unit;
}

std::vector<std::uint32_t> Splitter::order() {
    std::vector<Range> todo{{0, boxes_.size()}};
    while (!todo.empty()) {
        const auto range = todo.back();
        todo.pop_back();
        if (range.size() < 2) continue;
        Cut cut;
        for (std::size_t axis = 0; axis < 3; ++axis) look_along(axis, range, unit_of(range.size()), cut);
        divide(range, cut);
        todo.push_back({cut.place, range.end});
        todo.push_back({range.first, cut.place});
    }
    return sorted_[0];
}

} // namespace

std::vector<std::uint32_t> sah_order(const Mesh& mesh) { return Splitter(mesh).order(); }

} // namespace tandem
