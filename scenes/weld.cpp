// SPDX-License-Identifier: MIT
#include "scenes/weld.h"

#include <algorithm>
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

/// The smallest number of a set; halves the path to it.
std::uint32_t first_of(std::vector<std::uint32_t>& sets, std::uint32_t point) {
    while (sets[point] != point) point = sets[point] = sets[sets[point]];
    return point;
}

void join(std::vector<std::uint32_t>& sets, std::uint32_t a, std::uint32_t b) {
    a = first_of(sets, a);
    b = first_of(sets, b);
    sets[std::max(a, b)] = std::min(a, b);
}

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

/// With a tolerance, points are in cubes of that side, so that near points are in adjacent cubes.
std::vector<std::uint32_t> welded_vertices(std::span<const Eigen::Vector3d> positions, double tolerance) {
    if (!(tolerance > 0)) return welded_exactly(positions);
    std::vector<std::uint32_t> sets(positions.size());
    std::iota(sets.begin(), sets.end(), 0u);
    PointTable table(positions.size());
    for (std::uint32_t v = 0; v < positions.size(); ++v) {
        const Eigen::Vector3d cube = (positions[v] / tolerance).array().floor();
        const auto join_near = [&](std::uint32_t u) {
            if ((positions[u] - positions[v]).stableNorm() <= tolerance) join(sets, u, v);
            return false;
        };
        for (int i = 0; i < 27; ++i)
            table.any(cube + Eigen::Vector3d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1), join_near);
        table.add(cube, v);
    }
    for (std::uint32_t v = 0; v < sets.size(); ++v) sets[v] = first_of(sets, v);
    return sets;
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
