// SPDX-License-Identifier: MIT
#include "algorithms/orders/breadth_order.h"

#include "algorithms/orders/order.h"
#include "scenes/faces.h"

#include <algorithm>

namespace tandem {

namespace {

class BreadthFirst {
public:
    explicit BreadthFirst(const Mesh& mesh);

    /// Appends every tetrahedron that is reachable from `start`, unless the order already contains it.
    void from(std::uint32_t start);
    std::vector<std::uint32_t> take() { return std::move(order_); }

private:
    void append(std::uint32_t tetrahedron);
    void append_across(std::size_t face);

    std::vector<Face> faces_;
    /// [4 * tetrahedron + corner]: the first entry of faces_ with the same vertices.
    std::vector<std::size_t> first_;
    std::vector<std::uint8_t> is_reached_;
    /// By the first entry of equal faces: whether all their tetrahedra are reached.
    std::vector<std::uint8_t> is_crossed_;
    std::vector<std::uint32_t> order_; ///< also the queue of the search
};

BreadthFirst::BreadthFirst(const Mesh& mesh)
    : faces_(sorted_faces(mesh)),
      first_(faces_.size()),
      is_reached_(mesh.tetrahedra.size()),
      is_crossed_(faces_.size()) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        if (faces_[i].vertices != faces_[first].vertices) first = i;
        first_[std::size_t{4} * faces_[i].tetrahedron + faces_[i].corner] = first;
    }
    order_.reserve(mesh.tetrahedra.size());
}

void BreadthFirst::append(std::uint32_t tetrahedron) {
    if (is_reached_[tetrahedron]) return;
    is_reached_[tetrahedron] = 1;
    order_.push_back(tetrahedron);
}

void BreadthFirst::append_across(std::size_t face) {
    if (is_crossed_[face]) return;
    is_crossed_[face] = 1;
    for (auto i = face; i < faces_.size() && faces_[i].vertices == faces_[face].vertices; ++i)
        append(faces_[i].tetrahedron);
}

void BreadthFirst::from(std::uint32_t start) {
    auto next = order_.size();
    append(start);
    for (; next < order_.size(); ++next) {
        const auto known = static_cast<std::ptrdiff_t>(order_.size());
        for (std::size_t corner = 0; corner < 4; ++corner)
            append_across(first_[std::size_t{4} * order_[next] + corner]);
        std::sort(order_.begin() + known, order_.end());
    }
}

} // namespace

std::vector<std::uint32_t> breadth_order(const Mesh& mesh) {
    BreadthFirst search(mesh);
    for (const auto start : morton_order(mesh)) search.from(start);
    return search.take();
}

} // namespace tandem
