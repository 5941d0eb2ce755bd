// SPDX-License-Identifier: MIT
#include "scenes/weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

namespace tandem {

namespace {

constexpr std::uint32_t none = 0xffffffff;

/// Mixes three doubles; equal zeros of both signs have one hash.
std::size_t hash_of(const Eigen::Vector3d& v) {
    std::uint64_t hash = 0;
    for (const double x : v) {
        hash ^= std::bit_cast<std::uint64_t>(x + 0.0);
        hash *= 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    return hash;
}

/// Points by hash: chains of numbers with the same bucket, each in descending order.
class PointTable {
public:
    explicit PointTable(std::size_t points)
        : heads_(std::bit_ceil(std::max<std::size_t>(2 * points, 2)), none), next_(points, none) {}

    void add(const Eigen::Vector3d& key, std::uint32_t point) {
        auto& head = heads_[hash_of(key) & (heads_.size() - 1)];
        next_[point] = head;
        head = point;
    }
    /// Calls visit(point) for added points, among them all with this key, until it returns true.
    template<class Visit>
    bool any(const Eigen::Vector3d& key, Visit visit) const {
        for (auto at = heads_[hash_of(key) & (heads_.size() - 1)]; at != none; at = next_[at])
            if (visit(at)) return true;
        return false;
    }

private:
    std::vector<std::uint32_t> heads_, next_;
};

/// Sets of points, each named by its smallest number.
class Sets {
public:
    explicit Sets(std::size_t points) : parents_(points) { std::iota(parents_.begin(), parents_.end(), 0u); }
    /// The smallest number of a point's set; halves the path to it.
    std::uint32_t first(std::uint32_t point) {
        while (parents_[point] != point) point = parents_[point] = parents_[parents_[point]];
        return point;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = first(a);
        b = first(b);
        parents_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::uint32_t> parents_;
};

/// Joins near points by a k-d tree: halves along the longest side of their box. A node is whole when its
/// points are known to be in one set; two whole nodes of one set need no comparison of points.
class Welding {
public:
    Welding(std::span<const Eigen::Vector3d> points, double distance)
        : points_(points), tolerance_(distance), order_(points.size()), sets_(points.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
    }

    /// By point, the smallest number of its set.
    std::vector<std::uint32_t> run() {
        if (!points_.empty()) weld(build(0, order_.size()));
        std::vector<std::uint32_t> firsts(points_.size());
        for (std::uint32_t v = 0; v < firsts.size(); ++v) firsts[v] = sets_.first(v);
        return firsts;
    }

private:
    static constexpr std::size_t leaf_size = 8;

    struct Node {
        std::size_t begin, end;       ///< its points in order_
        std::uint32_t left, right;    ///< its children; none in a leaf
        Eigen::Vector3d lower, upper; ///< the box of its points
        bool is_whole;
    };

    std::uint32_t build(std::size_t begin, std::size_t end) {
        Node node{begin, end, none, none, points_[order_[begin]], points_[order_[begin]], false};
        for (auto i = begin; i < end; ++i) {
            node.lower = node.lower.cwiseMin(points_[order_[i]]);
            node.upper = node.upper.cwiseMax(points_[order_[i]]);
        }
        const auto number = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back(node);
        if (end - begin <= leaf_size) return number;
        Eigen::Index axis = 0;
        (node.upper - node.lower).maxCoeff(&axis);
        const auto middle = begin + (end - begin) / 2;
        const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
            return points_[a][axis] < points_[b][axis];
        });
        nodes_[number].left = build(begin, middle);
        nodes_[number].right = build(middle, end);
        return number;
    }

    std::uint32_t set_of(const Node& node) { return sets_.first(order_[node.begin]); }

    /// Joins near points within a node.
    void weld(std::uint32_t number) {
        auto& node = nodes_[number];
        if ((node.upper - node.lower).stableNorm() <= surely_near()) {
            join_all(node, order_[node.begin]);
        } else if (node.left == none) {
            for (auto i = node.begin; i < node.end; ++i)
                for (auto j = node.begin; j < i; ++j) join_near(order_[i], order_[j]);
        } else {
            weld(node.left);
            weld(node.right);
            weld(node.left, node.right);
        }
        update(node);
    }

    /// Joins near points of two nodes.
    void weld(std::uint32_t first, std::uint32_t second) {
        auto &a = nodes_[first], &b = nodes_[second];
        if (a.is_whole && b.is_whole && set_of(a) == set_of(b)) return;
        const Eigen::Vector3d gap = (a.lower - b.upper).cwiseMax(b.lower - a.upper).cwiseMax(0.0);
        if (gap.stableNorm() > possibly_near()) return;
        if ((a.upper.cwiseMax(b.upper) - a.lower.cwiseMin(b.lower)).stableNorm() <= surely_near()) {
            join_all(a, order_[b.begin]);
            join_all(b, order_[a.begin]);
        } else if (a.left != none && (b.left == none || a.end - a.begin >= b.end - b.begin)) {
            for (const auto child : children_of(a)) weld(child, second);
        } else if (b.left != none) {
            for (const auto child : children_of(b)) weld(first, child);
        } else {
            for (auto i = a.begin; i < a.end; ++i)
                for (auto j = b.begin; j < b.end; ++j) join_near(order_[i], order_[j]);
        }
        update(a);
        update(b);
    }

    /// A node's children, which are whole when it is.
    std::array<std::uint32_t, 2> children_of(const Node& node) {
        for (const auto child : {node.left, node.right}) nodes_[child].is_whole |= node.is_whole;
        return {node.left, node.right};
    }

    void join_all(Node& node, std::uint32_t point) {
        const auto end = node.is_whole ? node.begin + 1 : node.end;
        for (auto i = node.begin; i < end; ++i) sets_.join(order_[i], point);
        node.is_whole = true;
    }

    void join_near(std::uint32_t a, std::uint32_t b) {
        if ((points_[a] - points_[b]).stableNorm() <= tolerance_) sets_.join(a, b);
    }

    /// Points of a whole leaf or of two whole children of one set are in one set.
    void update(Node& node) {
        if (node.is_whole) return;
        if (node.left == none) {
            const auto is_here = [&](std::uint32_t point) { return sets_.first(point) == set_of(node); };
            node.is_whole = std::all_of(order_.begin() + static_cast<std::ptrdiff_t>(node.begin),
                                        order_.begin() + static_cast<std::ptrdiff_t>(node.end), is_here);
        } else {
            node.is_whole = nodes_[node.left].is_whole && nodes_[node.right].is_whole
                            && set_of(nodes_[node.left]) == set_of(nodes_[node.right]);
        }
    }

    /// Bounds of boxes are wider than rounding, so that join_near alone decides at the tolerance.
    double surely_near() const { return tolerance_ * (1 - 1e-12); }
    double possibly_near() const { return tolerance_ * (1 + 1e-12); }

    std::span<const Eigen::Vector3d> points_;
    double tolerance_;                 ///< points at most this far apart are joined
    std::vector<std::uint32_t> order_; ///< points, in the order of the tree's leaves
    Sets sets_;
    std::vector<Node> nodes_;
};

std::vector<std::uint32_t> welded_exactly(std::span<const Eigen::Vector3d> positions) {
    std::vector<std::uint32_t> firsts(positions.size());
    PointTable table(positions.size());
    for (std::uint32_t v = 0; v < positions.size(); ++v) {
        const auto is_here = [&](std::uint32_t u) {
            if (positions[u] != positions[v]) return false;
            firsts[v] = u;
            return true;
        };
        if (table.any(positions[v], is_here)) continue;
        firsts[v] = v;
        table.add(positions[v], v);
    }
    return firsts;
}

} // namespace

std::vector<std::uint32_t> welded_vertices(std::span<const Eigen::Vector3d> positions, double distance) {
    return distance > 0 ? Welding(positions, distance).run() : welded_exactly(positions);
}

std::size_t count_coincident(const Mesh& mesh) {
    std::vector<bool> is_used(mesh.vertices.size());
    for (const auto& tetrahedron : mesh.tetrahedra)
        for (const auto vertex : tetrahedron) is_used[vertex] = true;
    PointTable table(mesh.vertices.size());
    std::size_t count = 0;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        if (!is_used[v]) continue;
        const auto& position = mesh.vertices[v];
        if (table.any(position, [&](std::uint32_t u) { return mesh.vertices[u] == position; }))
            ++count;
        else
            table.add(position, v);
    }
    return count;
}

} // namespace tandem
