// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"
#include "geometry/facets.h"

namespace tandem::oracle {

/// What double arithmetic could certify.
struct Filtered {
    bool disjoint = false;        ///< certain
    FacetSet unsure = all_facets; ///< facets not certain to have a negative gap; none: overlapping
    bool volume[2]{false, false}; ///< certain that the tetrahedron has some
};

/// Semi-static filter. Signs are those of 3 x 3 determinants of differences of coordinates, n . d with n a
/// cross product: 8 roundings at most along any path, so the error is below gamma_8 (Higham 2002, 3.1) times
/// the sum of the terms' magnitudes, the permanent of Shewchuk's orient3d bound (1997). That
/// sum is at most |n|_1, taken with magnitudes, times the largest difference; 12 u covers gamma_8 = 8 u and
/// the roundings of the bound itself, and 2^-700 all underflow as long as differences are below 2^300.
/// Coordinates must be finite; larger ones are left undecided.
///
/// What is certain is so for all tetrahedra whose coordinates differ from these by at most `off`. Differences
/// then differ by s = 2 off at most, and a sign by the sum over its six terms p q d of
/// (|p| + s)(|q| + s)(|d| + s) - |p q d|. With m the sum of |p q| and m' that of (|p| + s)(|q| + s), which is
/// m + 2 s (|p|_1 + |q|_1) + 6 s^2, this is at most m s + (m' - m)(size + s); every part of it has a factor
/// s, so that its roundings are covered by an s that is 2^-40 larger.
Filtered filter(const TetraCorners& a, const TetraCorners& b, double off = 0);

/// The sign of facets.h's orientation where double arithmetic is certain of it; 0: unsure. The same bound.
int certain_orientation(const TetraCorners& corners);

} // namespace tandem::oracle
