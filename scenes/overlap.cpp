// SPDX-License-Identifier: MIT
#include "scenes/overlap.h"

#include "scenes/motion.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace tandem {

namespace {

constexpr double tolerance = 1e-5; ///< times the smaller body's diagonal

using Box = Eigen::AlignedBox3d;

/// A body in world coordinates.
struct Solid {
    std::vector<Eigen::Vector3d> vertices;
    const std::vector<Tetrahedron>* tetrahedra;
    Box box;
    std::size_t body;

    Corners3 corners(std::size_t t) const {
        const auto& v = (*tetrahedra)[t];
        return {vertices[v[0]], vertices[v[1]], vertices[v[2]], vertices[v[3]]};
    }
};

Solid solid_of(const Scene& scene, const Frame& frame, std::size_t body) {
    const auto& mesh = scene.meshes[scene.bodies[body].mesh];
    Solid solid{{}, &mesh.tetrahedra, {}, body};
    if (scene.bodies[body].deformable)
        solid.vertices = frame.deformed[body];
    else
        for (const auto& v : mesh.vertices)
            solid.vertices.push_back(rotated(frame.poses[body].rotation, v) + frame.poses[body].translation);
    for (const auto& v : solid.vertices) solid.box.extend(v);
    return solid;
}

/// Tetrahedra whose boxes intersect `region`, with these boxes, in ascending order of their least x.
std::vector<std::pair<Box, std::size_t>> tetrahedra_in(const Solid& solid, const Box& region) {
    std::vector<std::pair<Box, std::size_t>> found;
    for (std::size_t t = 0; t < solid.tetrahedra->size(); ++t) {
        Box box;
        for (const auto& corner : solid.corners(t)) box.extend(corner);
        if (box.intersects(region)) found.emplace_back(box, t);
    }
    std::sort(found.begin(), found.end(),
              [](const auto& a, const auto& b) { return a.first.min().x() < b.first.min().x(); });
    return found;
}

/// Sweeps along x the tetrahedra of each body whose boxes intersect the other body's box.
bool bodies_overlap(const Solid& a, const Solid& b) {
    const double slack = tolerance * std::min(a.box.diagonal().norm(), b.box.diagonal().norm());
    const auto candidates_b = tetrahedra_in(b, a.box);
    for (const auto& [box_a, t] : tetrahedra_in(a, b.box))
        for (const auto& [box_b, u] : candidates_b) {
            if (box_b.min().x() > box_a.max().x()) break;
            if (box_a.intersects(box_b) && overlap(a.corners(t), b.corners(u), slack)) return true;
        }
    return false;
}

/// Least and largest coordinate along an axis of any length.
std::array<double, 2> range(const Corners3& corners, const Eigen::Vector3d& axis) {
    std::array<double, 2> result{axis.dot(corners[0]), axis.dot(corners[0])};
    for (const auto& corner : corners) {
        result[0] = std::min(result[0], axis.dot(corner));
        result[1] = std::max(result[1], axis.dot(corner));
    }
    return result;
}

/// Also true for an axis close to zero, which parallel edges and flat tetrahedra give.
bool overlap_along(const Eigen::Vector3d& axis, const Corners3& a, const Corners3& b, double slack) {
    const double length = axis.norm();
    if (!(length > 1e-12 * (a[1] - a[0]).norm() * (b[1] - b[0]).norm())) return true;
    const auto [a_low, a_high] = range(a, axis);
    const auto [b_low, b_high] = range(b, axis);
    return std::min(a_high, b_high) - std::max(a_low, b_low) > slack * length;
}

std::array<Eigen::Vector3d, 6> edges(const Corners3& t) {
    return {t[1] - t[0], t[2] - t[0], t[3] - t[0], t[2] - t[1], t[3] - t[1], t[3] - t[2]};
}

std::array<Eigen::Vector3d, 4> normals(const std::array<Eigen::Vector3d, 6>& e) {
    return {e[0].cross(e[1]), e[0].cross(e[2]), e[1].cross(e[2]), e[3].cross(e[4])};
}

} // namespace

bool overlap(const Corners3& a, const Corners3& b, double slack) {
    const auto edges_a = edges(a);
    const auto edges_b = edges(b);
    for (const auto& axis : normals(edges_a))
        if (!overlap_along(axis, a, b, slack)) return false;
    for (const auto& axis : normals(edges_b))
        if (!overlap_along(axis, a, b, slack)) return false;
    for (const auto& p : edges_a)
        for (const auto& q : edges_b)
            if (!overlap_along(p.cross(q), a, b, slack)) return false;
    return true;
}

std::optional<std::array<std::size_t, 2>> first_overlap(const Scene& scene, const Frame& frame,
                                                        bool only_fixed) {
    std::vector<Solid> solids;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        if (!only_fixed || scene.bodies[i].fixed) solids.push_back(solid_of(scene, frame, i));
    std::sort(solids.begin(), solids.end(),
              [](const Solid& a, const Solid& b) { return a.box.min().x() < b.box.min().x(); });
    std::optional<std::array<std::size_t, 2>> first;
    for (auto a = solids.begin(); a != solids.end(); ++a)
        for (auto b = a + 1; b != solids.end() && b->box.min().x() <= a->box.max().x(); ++b) {
            const std::array<std::size_t, 2> pair{std::min(a->body, b->body), std::max(a->body, b->body)};
            // The sweep runs in the order of x, but the result is the first pair in the order of numbers.
            if (!a->box.intersects(b->box) || (first && *first < pair) || !bodies_overlap(*a, *b)) continue;
            first = pair;
        }
    return first;
}

} // namespace tandem
