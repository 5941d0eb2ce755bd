// SPDX-License-Identifier: MIT
#include "scenes/simulate/cone.h"

#include "scenes/simulate/algebra.h"

#include <algorithm>

namespace tandem::simulate {

namespace {

using Rays = std::span<const Eigen::Vector3d>;

constexpr double rounding = 1e-8;    ///< error of directions from sums of rays about 1e-7 apart
constexpr int most_projections = 64; ///< pairs of projections; planes that cross need one or two

/// Keeps the projection of x that is nearer to x. It is the longer one; distances near 1 are too inexact.
void keep_nearer(const Eigen::Vector3d& candidate, Eigen::Vector3d& best) {
    if (dot(candidate, candidate) > dot(best, best)) best = candidate;
}

/// Tries the projection of x onto the plane through rays g and h when it lies between them.
void try_between(const Eigen::Vector3d& g, const Eigen::Vector3d& h, const Eigen::Vector3d& x,
                 Eigen::Vector3d& best) {
    const double gh = dot(g, h), gx = dot(g, x), hx = dot(h, x);
    const double area = 1 - gh * gh;
    if (!(area > 0)) return;
    const double along_g = (gx - gh * hx) / area, along_h = (hx - gh * gx) / area;
    if (along_g > 0 && along_h > 0) keep_nearer(along_g * g + along_h * h, best);
}

/// The ray with the smallest angle to x.
Eigen::Vector3d closest_ray(Rays rays, const Eigen::Vector3d& x) {
    return *std::max_element(rays.begin(), rays.end(),
                             [&](const auto& a, const auto& b) { return dot(a, x) < dot(b, x); });
}

/// The projection of x onto the cone with length 1; the closest ray when the whole cone lies behind x.
Eigen::Vector3d project(Rays rays, const Eigen::Vector3d& x) {
    if (rays.empty()) return x;
    const auto nearest = nearest_in_cone(rays, x);
    const double size = length(nearest);
    return size > 1e-6 ? Eigen::Vector3d(nearest / size) : closest_ray(rays, x);
}

Eigen::Vector3d project_alternately(Rays one, Rays other, const Eigen::Vector3d& start) {
    Eigen::Vector3d x = start;
    for (int i = 0; i < most_projections; ++i) {
        const Eigen::Vector3d before = x;
        x = project(other, project(one, x));
        if (length(x - before) < 1e-12) break;
    }
    return x;
}

/// The sum of all rays. For cones with opposite rays, only their common direction remains.
Eigen::Vector3d sum_of(Rays one, Rays other) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& ray : one) sum += ray;
    for (const auto& ray : other) sum += ray;
    return sum;
}

} // namespace

Eigen::Vector3d nearest_in_cone(Rays rays, const Eigen::Vector3d& direction) {
    // The nearest point on the cone's edges and sides is the result, unless a ray leads from it closer to
    // `direction`, which then lies inside.
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const double along = dot(rays[i], direction);
        if (along > 0) keep_nearer(along * rays[i], best);
        for (std::size_t j = 0; j < i; ++j) try_between(rays[i], rays[j], direction, best);
    }
    const Eigen::Vector3d rest = direction - best;
    const bool inside =
        std::any_of(rays.begin(), rays.end(), [&](const auto& ray) { return dot(ray, rest) > rounding; });
    return inside ? direction : best;
}

double outside(Rays one, Rays other, const Eigen::Vector3d& direction) {
    double farthest = 0;
    for (const auto& rays : {one, other})
        if (!rays.empty())
            farthest = std::max(farthest, length(direction - nearest_in_cone(rays, direction)));
    return farthest;
}

Eigen::Vector3d moved_into_cones(Rays one, Rays other, const Eigen::Vector3d& direction) {
    auto nearest = project_alternately(one, other, direction);
    const double distance = outside(one, other, nearest);
    const auto middle = sum_of(one, other);
    if (distance < rounding || !(length(middle) > rounding)) return nearest;
    // Opposite sides of flush bodies make the projections oscillate, so start again from the middle.
    const auto second = project_alternately(one, other, middle / length(middle));
    return outside(one, other, second) < distance ? second : nearest;
}

} // namespace tandem::simulate
