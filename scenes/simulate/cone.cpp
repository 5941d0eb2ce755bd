// SPDX-License-Identifier: MIT
#include "scenes/simulate/cone.h"

#include "scenes/simulate/algebra.h"

#include <algorithm>

namespace tandem::simulate {

namespace {

using Rays = std::span<const Eigen::Vector3d>;

constexpr double rounding = 1e-8; ///< of directions that sums of rays some 1e-7 apart are taken from
constexpr int most_turns = 64;    ///< of projections; those onto planes that cross need one or two

/// Keeps of two points that x is projected to the nearer one: the longer, which distances near 1 cannot tell.
void keep_nearer(const Eigen::Vector3d& candidate, Eigen::Vector3d& best) {
    if (dot(candidate, candidate) > dot(best, best)) best = candidate;
}

/// Of the part of the plane through rays g and h that lies between them, where x is above it.
void try_between(const Eigen::Vector3d& g, const Eigen::Vector3d& h, const Eigen::Vector3d& x,
                 Eigen::Vector3d& best) {
    const double gh = dot(g, h), gx = dot(g, x), hx = dot(h, x);
    const double area = 1 - gh * gh;
    if (!(area > 0)) return;
    const double along_g = (gx - gh * hx) / area, along_h = (hx - gh * gx) / area;
    if (along_g > 0 && along_h > 0) keep_nearer(along_g * g + along_h * h, best);
}

/// The ray that turns away least.
Eigen::Vector3d closest_ray(Rays rays, const Eigen::Vector3d& x) {
    return *std::max_element(rays.begin(), rays.end(),
                             [&](const auto& a, const auto& b) { return dot(a, x) < dot(b, x); });
}

/// Projected and of length 1 again; onto a ray where the cone lies all behind x.
Eigen::Vector3d turned_into(Rays rays, const Eigen::Vector3d& x) {
    if (rays.empty()) return x;
    const auto nearest = nearest_in_cone(rays, x);
    const double size = length(nearest);
    return size > 1e-6 ? Eigen::Vector3d(nearest / size) : closest_ray(rays, x);
}

Eigen::Vector3d in_turn(Rays one, Rays other, const Eigen::Vector3d& start) {
    Eigen::Vector3d x = start;
    for (int turn = 0; turn < most_turns; ++turn) {
        const Eigen::Vector3d before = x;
        x = turned_into(other, turned_into(one, x));
        if (length(x - before) < 1e-12) break;
    }
    return x;
}

/// The sum of all rays: of two cones that oppose each other what they have in common is left.
Eigen::Vector3d middle_of(Rays one, Rays other) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& ray : one) sum += ray;
    for (const auto& ray : other) sum += ray;
    return sum;
}

} // namespace

Eigen::Vector3d nearest_in_cone(Rays rays, const Eigen::Vector3d& direction) {
    // The nearest point of the cone's edges and sides is the answer unless some ray leads from it nearer to
    // x: then x lies inside.
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

Eigen::Vector3d brought_into(Rays one, Rays other, const Eigen::Vector3d& direction) {
    auto nearest = in_turn(one, other, direction);
    const double off = outside(one, other, nearest);
    const auto middle = middle_of(one, other);
    if (off < rounding || !(length(middle) > rounding)) return nearest;
    // Between sides that oppose each other, those of bodies that stand flush, projections go to and fro.
    const auto second = in_turn(one, other, middle / length(middle));
    return outside(one, other, second) < off ? second : nearest;
}

} // namespace tandem::simulate
