// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>

namespace tandem {

/// Distance of `point` from the convex hull of `vertices` (at least one), in their units; 0 inside. Least
/// norm in a polytope by Wolfe 1976 (Mathematical Programming 11, 128-149), in double; the error is about
/// 1e-15 of the hull's size.
double distance_to_hull(std::span<const std::array<double, 3>> vertices, const std::array<double, 3>& point);

/// Hausdorff distance of two finite, non-empty sets: the largest distance of an element of one set to the
/// nearest element of the other.
double hausdorff_distance(std::span<const std::array<double, 3>> p, std::span<const std::array<double, 3>> q);

} // namespace tandem
