// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"
#include "geometry/facets.h"

#include <gmpxx.h>
#include <optional>
#include <vector>

namespace tandem::oracle {

using RationalPoint = Vector<mpq_class>;

/// What contact_truth.h rounds, in the coordinates' own units.
struct ExactContact {
    Relation relation = Relation::disjoint;
    std::vector<RationalPoint> vertices; ///< of the intersection, without repetition, ascending
    mpq_class volume;
    mpq_class depth_squared;                ///< of the least translation that leaves no inner point in common
    std::vector<Vector<mpz_class>> normals; ///< of facets that are at most (1 + slack) times as deep
};

/// Nothing when a coordinate is not finite or a tetrahedron has no volume.
std::optional<ExactContact> exact_contact(const TetraCorners& a, const TetraCorners& b, double slack);

/// Vertices of the intersection of two tetrahedra with volume, ascending: each is an end of the part of an
/// edge of one that lies in the other, since two of the three planes that meet there are one tetrahedron's.
std::vector<RationalPoint> intersection_vertices(const Points<mpz_class>& a, const Points<mpz_class>& b);

/// Volume of the intersection with these vertices: pyramids from the first over each facet.
mpq_class intersection_volume(const Points<mpz_class>& a, const Points<mpz_class>& b,
                              const std::vector<RationalPoint>& vertices);

} // namespace tandem::oracle
