// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"
#include "geometry/facets.h"

#include <gmpxx.h>
#include <optional>
#include <vector>

namespace tandem::geometry {

using RationalPoint = Vector<mpq_class>;

/// The exact values that contact_truth() rounds, in the units of the coordinates.
struct ExactContact {
    Relation relation = Relation::disjoint;
    std::vector<RationalPoint> vertices; ///< of the intersection, unique, ascending
    mpq_class volume;
    mpq_class depth_squared; ///< of the least translation after which no interior point is shared
    std::vector<Vector<mpz_class>> normals; ///< of facets that are at most (1 + slack) times as deep
};

/// No value when a coordinate is not finite or a tetrahedron has no volume.
std::optional<ExactContact> exact_contact(const TetraCorners& a, const TetraCorners& b, double slack);

/// Vertices of the intersection of two tetrahedra with volume, ascending. Each is an end of the part of an
/// edge of one that lies in the other, since two of the three planes through it belong to one tetrahedron.
std::vector<RationalPoint> intersection_vertices(const Points<mpz_class>& a, const Points<mpz_class>& b);

/// Volume of the intersection with these vertices: the pyramids from the first vertex over each facet.
mpq_class intersection_volume(const Points<mpz_class>& a, const Points<mpz_class>& b,
                              const std::vector<RationalPoint>& vertices);

} // namespace tandem::geometry
