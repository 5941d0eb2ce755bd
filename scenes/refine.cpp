// SPDX-License-Identifier: MIT
#include "scenes/refine.h"

#include "base/error.h"
#include "base/memory.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <span>
#include <string_view>
#include <unordered_map>

namespace tandem {

namespace {

constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max();

/// Points of a tetrahedron: corners 0..3, then the midpoints of these edges.
constexpr std::array<std::array<std::uint32_t, 2>, 6> edges = {
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
enum Point : std::uint8_t { p0, p1, p2, p3, m01, m02, m03, m12, m13, m23 };

/// Bey's children. Corners 0 and 2 of the sixth and the eighth are swapped, so that all have the orientation
/// of their parent. The swap does not change their own inner edge.
constexpr std::array<std::array<Point, 4>, 8> children = {{{p0, m01, m02, m03},
                                                           {m01, p1, m12, m13},
                                                           {m02, m12, p2, m23},
                                                           {m03, m13, m23, p3},
                                                           {m01, m02, m03, m13},
                                                           {m12, m02, m01, m13},
                                                           {m02, m03, m13, m23},
                                                           {m13, m12, m02, m23}}};

/// Bit i is set when the point lies in the face opposite corner i.
constexpr unsigned faces_of(Point point) {
    if (point < m01) return 0b1111u & ~(1u << point);
    const auto& edge = edges[point - m01];
    return 0b1111u & ~(1u << edge[0]) & ~(1u << edge[1]);
}

/// Boundary flags of a child: its faces that lie in boundary faces of its parent.
std::uint8_t child_boundary(const std::array<Point, 4>& child, unsigned parent) {
    unsigned flags = 0;
    for (std::size_t corner = 0; corner < 4; ++corner) {
        unsigned shared = parent;
        for (std::size_t i = 0; i < 4; ++i)
            if (i != corner) shared &= faces_of(child[i]);
        if (shared != 0) flags |= 1u << corner;
    }
    return static_cast<std::uint8_t>(flags);
}

std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

/// Every edge once, in ascending order.
std::vector<std::uint64_t> edges_of(const Mesh& mesh) {
    std::vector<std::uint64_t> keys;
    keys.reserve(mesh.tetrahedra.size() * edges.size());
    for (const auto& t : mesh.tetrahedra)
        for (const auto& [a, b] : edges) keys.push_back(key_of(t[a], t[b]));
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    keys.shrink_to_fit();
    return keys;
}

void check_count(std::size_t count, std::string_view what, const std::string& name) {
    if (count > most)
        throw InputError(
            fmt::format("mesh {} would have {} {} after refinement, which exceeds 32-bit numbers; "
                        "refine less",
                        name, count, what));
}

/// Numbers of the ten points of a tetrahedron in the refined mesh.
std::array<std::uint32_t, 10> points_of(const Tetrahedron& t, std::span<const std::uint64_t> keys,
                                        std::size_t corners) {
    std::array<std::uint32_t, 10> numbers{t[0], t[1], t[2], t[3]};
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto found = std::lower_bound(keys.begin(), keys.end(), key_of(t[edges[e][0]], t[edges[e][1]]));
        numbers[4 + e] = static_cast<std::uint32_t>(corners + static_cast<std::size_t>(found - keys.begin()));
    }
    return numbers;
}

/// Children of merged tetrahedra are merged. Midpoints are welded when the ends of their edges are.
void refine_topology(const Mesh& mesh, std::span<const std::uint64_t> keys, Mesh& fine) {
    for (const auto t : mesh.merged)
        for (std::uint32_t child = 0; child < children.size(); ++child)
            fine.merged.push_back(static_cast<std::uint32_t>(children.size()) * t + child);
    if (mesh.welded.empty()) return;
    fine.welded = mesh.welded;
    std::unordered_map<std::uint64_t, std::uint32_t> firsts;
    for (const auto key : keys) {
        const auto number = static_cast<std::uint32_t>(fine.welded.size());
        const auto ends = key_of(joined(mesh, static_cast<std::uint32_t>(key >> 32)),
                                 joined(mesh, static_cast<std::uint32_t>(key & most)));
        fine.welded.push_back(firsts.try_emplace(ends, number).first->second);
    }
}

Mesh refined_once(const Mesh& mesh) {
    const auto keys = edges_of(mesh);
    check_count(mesh.vertices.size() + keys.size(), "vertices", mesh.name);
    Mesh fine{.name = mesh.name, .vertices = {}, .tetrahedra = {}, .boundary = {}};
    fine.vertices.reserve(mesh.vertices.size() + keys.size());
    fine.vertices = mesh.vertices;
    for (const auto key : keys)
        fine.vertices.push_back(0.5 * (mesh.vertices[key >> 32] + mesh.vertices[key & most]));
    fine.pressures = mesh.pressures;
    for (const auto key : keys)
        if (!mesh.pressures.empty())
            fine.pressures.push_back(0.5 * (mesh.pressures[key >> 32] + mesh.pressures[key & most]));
    fine.tetrahedra.reserve(mesh.tetrahedra.size() * children.size());
    fine.boundary.reserve(mesh.tetrahedra.size() * children.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const auto numbers = points_of(mesh.tetrahedra[t], keys, mesh.vertices.size());
        for (const auto& child : children) {
            fine.tetrahedra.push_back(
                {numbers[child[0]], numbers[child[1]], numbers[child[2]], numbers[child[3]]});
            fine.boundary.push_back(child_boundary(child, mesh.boundary[t]));
        }
    }
    refine_topology(mesh, keys, fine);
    fine.findings = mesh.findings;
    fine.reading = mesh.reading;
    fine.findings.duplicates *= children.size();
    return fine;
}

} // namespace

Mesh refined(const Mesh& mesh, std::uint64_t levels) {
    if (levels > most_refinement)
        throw InputError(
            fmt::format("refinement by {} levels; give a number from 0 to {}", levels, most_refinement));
    check_count(mesh.tetrahedra.size() << 3 * levels, "tetrahedra", mesh.name);
    // Corners and flags of a child, at least a sixth of a vertex, and an eighth of the parent's six edges.
    constexpr double bytes_per_tetrahedron =
        4 * sizeof(std::uint32_t) + 1 + sizeof(Eigen::Vector3d) / 6.0 + 6;
    if (levels > 0)
        refuse_beyond_memory(fmt::format("the tetrahedra of mesh {} refined {} times", mesh.name, levels),
                             bytes_per_tetrahedron
                                 * static_cast<double>(mesh.tetrahedra.size() << 3 * levels));
    Mesh fine = mesh;
    for (std::uint64_t level = 0; level < levels; ++level) fine = refined_once(fine);
    if (levels > 0) count_flawed(fine);
    return fine;
}

} // namespace tandem
