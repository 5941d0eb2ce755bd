// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"

#include <optional>
#include <vector>

namespace tandem {

/// What two tetrahedra have in common and how far they would have to move, in the coordinates' units. All is
/// computed in rationals; every number is rounded once, to the nearest double.
struct ContactTruth {
    Relation relation = Relation::disjoint;      ///< disjoint: everything below is empty or zero
    std::vector<std::array<double, 3>> vertices; ///< of the intersection, a convex polytope
    double volume = 0;                           ///< of the intersection
    double depth = 0;         ///< length of the least translation that leaves no inner point in common
    double depth_squared = 0; ///< its square, rounded on its own
    /// Unit directions for that translation of B, out of A: all whose facet is at most (1 + slack) times as
    /// deep, since ties are common. Directions may repeat when faces and products of edges are parallel.
    std::vector<std::array<double, 3>> normals;
};

/// Nothing when a coordinate is not finite or a tetrahedron has no volume. The depth is the distance of the
/// origin from the boundary of the Minkowski difference A - B, whose facets are faces of A, faces of B and
/// products of an edge of each. About 0.1 ms for a pair of floats.
std::optional<ContactTruth> contact_truth(const TetraCorners& a, const TetraCorners& b, double slack = 1e-6);

} // namespace tandem
