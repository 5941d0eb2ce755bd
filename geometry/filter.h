// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"
#include "geometry/facets.h"

namespace tandem::geometry {

/// What double arithmetic can certify about a pair.
struct Filtered {
    bool disjoint = false;        ///< certainly disjoint
    FacetSet unsure = all_facets; ///< facets whose gap is not certainly negative; none: overlapping
    bool volume[2]{false, false}; ///< whether each tetrahedron certainly has volume
};

/// Semi-static filter. It computes signs of 3 x 3 determinants of coordinate differences, n . d with n a
/// cross product. Any path has at most 8 roundings, so the error is below gamma_8 (Higham 2002, 3.1) times
/// the sum of the terms' magnitudes. This sum is the permanent of Shewchuk's orient3d bound (1997). It is at
/// most |n|_1, taken with magnitudes, times the largest difference. The factor 12 u covers gamma_8 = 8 u and
/// the roundings of the bound itself. The term 2^-700 covers all underflow while differences are below 2^300.
/// Coordinates must be finite; larger ones stay undecided.
///
/// Certain results hold for all tetrahedra whose coordinates differ from these by at most `error`.
/// Differences then differ by at most s = 2 error. A determinant then differs by at most the sum over its six
/// terms p q d of (|p| + s)(|q| + s)(|d| + s) - |p q d|. Let m be the sum of |p q|, and m' that of
/// (|p| + s)(|q| + s), which is m + 2 s (|p|_1 + |q|_1) + 6 s^2. The bound is then m s + (m' - m)(size + s).
/// Each part has a factor s, so a value of s that is 2^-40 larger covers the roundings.
Filtered filter(const TetraCorners& a, const TetraCorners& b, double error = 0);

/// The sign of orientation() in facets.h when double arithmetic is certain; 0 when uncertain. The same bound.
int certain_orientation(const TetraCorners& corners);

/// Whether a point is certainly inside a tetrahedron, for all corners that differ from these by at most
/// `error`. The same bound.
bool certainly_inside(const Vector<double>& point, const TetraCorners& corners, double error);

} // namespace tandem::geometry
