// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>

namespace tandem::support {

template<class Real>
using FourCornersOf = std::array<Eigen::Vector3<Real>, 4>;
using FourCorners = FourCornersOf<double>;

/// The distance of two segments: of the end points from the other segment, or of the lines where both feet
/// are inside.
template<class Real>
Real segment_distance(const Eigen::Vector3<Real>& a, const Eigen::Vector3<Real>& b,
                      const Eigen::Vector3<Real>& c, const Eigen::Vector3<Real>& d) {
    const auto from_segment = [](const Eigen::Vector3<Real>& p, const Eigen::Vector3<Real>& from,
                                 const Eigen::Vector3<Real>& to) {
        const Eigen::Vector3<Real> along = to - from;
        const Real s = std::clamp((p - from).dot(along) / along.squaredNorm(), Real(0), Real(1));
        return (p - from - s * along).norm();
    };
    Real least = std::min(
        {from_segment(a, c, d), from_segment(b, c, d), from_segment(c, a, b), from_segment(d, a, b)});
    const Eigen::Vector3<Real> u = b - a, v = d - c, w = c - a, n = u.cross(v);
    const Real length = n.squaredNorm();
    if (length == 0) return least;
    const Real s = w.cross(v).dot(n) / length, t = w.cross(u).dot(n) / length;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) least = std::min(least, std::abs(w.dot(n)) / n.norm());
    return least;
}

/// The distance of a point from a triangle's plane, where its foot is inside; infinity elsewhere.
template<class Real>
Real plane_distance(const Eigen::Vector3<Real>& p, const Eigen::Vector3<Real>& a,
                    const Eigen::Vector3<Real>& b, const Eigen::Vector3<Real>& c) {
    const Eigen::Vector3<Real> n = (b - a).cross(c - a);
    const bool inside = n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0
                        && n.dot((a - c).cross(p - c)) >= 0;
    return inside ? std::abs(n.dot(p - a)) / n.norm() : std::numeric_limits<Real>::infinity();
}

/// The least distance between the surfaces' corners, edges and faces, up to rounding in Real. For two that
/// are apart it is their distance.
template<class Real>
Real distance_between(const FourCornersOf<Real>& a, const FourCornersOf<Real>& b) {
    constexpr int edges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    constexpr int faces[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
    Real least = std::numeric_limits<Real>::infinity();
    for (const auto& e : edges)
        for (const auto& f : edges)
            least = std::min(least, segment_distance(a[e[0]], a[e[1]], b[f[0]], b[f[1]]));
    for (const auto& f : faces)
        for (int i = 0; i < 4; ++i) {
            least = std::min(least, plane_distance(a[i], b[f[0]], b[f[1]], b[f[2]]));
            least = std::min(least, plane_distance(b[i], a[f[0]], a[f[1]], a[f[2]]));
        }
    return least;
}

/// Whether two are farther apart than a limit along an axis, and so in space; most pairs of a scene are.
inline bool are_beyond(const FourCorners& a, const FourCorners& b, double limit) {
    for (int axis = 0; axis < 3; ++axis) {
        double low_a = a[0][axis], high_a = low_a, low_b = b[0][axis], high_b = low_b;
        for (std::size_t i = 1; i < 4; ++i) {
            low_a = std::min(low_a, a[i][axis]);
            high_a = std::max(high_a, a[i][axis]);
            low_b = std::min(low_b, b[i][axis]);
            high_b = std::max(high_b, b[i][axis]);
        }
        if (low_a - high_b > limit || low_b - high_a > limit) return true;
    }
    return false;
}

/// The corners of a tetrahedron of a body, as the scene has them.
inline FourCorners corners_of(const Scene& scene, const Frame& frame, std::uint32_t body,
                              std::uint32_t number) {
    const auto& mesh = scene.meshes[scene.bodies[body].mesh];
    FourCorners corners;
    for (int i = 0; i < 4; ++i) {
        const auto vertex = mesh.tetrahedra[number][static_cast<std::size_t>(i)];
        const auto& pose = frame.poses[body];
        corners[static_cast<std::size_t>(i)] =
            scene.bodies[body].deformable
                ? frame.deformed[body][vertex]
                : pose.rotation.normalized() * mesh.vertices[vertex] + pose.translation;
    }
    return corners;
}

} // namespace tandem::support
