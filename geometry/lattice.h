// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"
#include "geometry/facets.h"

#include <gmpxx.h>
#include <span>
#include <vector>

namespace tandem::geometry {

__extension__ using Int128 = __int128;

/// Both tetrahedra in exact units of 2^exponent, relative to A's first corner.
template<class Number>
struct Lattice {
    Points<Number> a, b;
    int exponent = 0;
};

/// For coordinates at most 2^40 units from A's first corner; no value for others. Differences are then below
/// 2^41, and every number in facets.h is below 3 * 2 * 2^(3 * 41) < 2^126. Coordinates must be finite.
std::optional<Lattice<Int128>> small_lattice(const TetraCorners& a, const TetraCorners& b);

/// For all finite coordinates.
Lattice<mpz_class> big_lattice(const TetraCorners& a, const TetraCorners& b);

/// Finite points in exact units of 2^exponent, relative to the first one.
struct LatticePoints {
    std::vector<Vector<mpz_class>> points;
    int exponent = 0;
};
LatticePoints lattice_points(std::span<const std::array<double, 3>> points);

} // namespace tandem::geometry
