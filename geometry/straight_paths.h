// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/meet_in_motion.h"

namespace tandem::geometry {

/// Whether two tetrahedra whose corners move on straight lines have a common point at some time in (0, 1),
/// when they have none at 0. Exact for all finite coordinates.
///
/// At the first such time a plane separates the tetrahedra weakly, and a vertex of their intersection is a
/// contact of two features: a corner on a face, or two edges that cross. When all corners are on one line it
/// is a corner on an edge, or two equal corners. Each contact is an equation f(s) = 0 with conditions
/// g(s) >= 0 and h(s) > 0 in integer polynomials of degree 4 at most. The first time is a root of f, unless f
/// is zero at all times. Features that stay in one plane first meet with a corner on an edge, and those on
/// one line with equal corners.
bool meet_on_straight_paths(const MovingTetra& a, const MovingTetra& b);

} // namespace tandem::geometry
