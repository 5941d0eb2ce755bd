// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/hard/hard.h"

namespace tandem::hard {

using Corners = std::array<Eigen::Vector3d, 4>;

/// A uniform random integer from `low` to `high`.
int whole(Random& random, int low, int high);

/// Converts x to float. Throws std::logic_error when this is inexact, since an exact construction must not
/// round.
float exact(double x);

/// A pair with these corners in random order. Every coordinate must be exact in float.
HardPair exact_pair(Random& random, const Corners& a, const Corners& b, Known known = Known::open);

/// A pair with these corners in random order, rounded to the nearest floats.
HardPair rounded_pair(Random& random, const Corners& a, const Corners& b, Known known = Known::open);

Corners moved(Corners corners, const Eigen::Vector3d& by);
Corners scaled(Corners corners, double by);

/// Six times the signed volume; exact for small integers.
double determinant(const Corners& corners);

/// A random tetrahedron in the cube of side 2 about the origin, not flat.
Corners random_tetrahedron(Random& random);

/// Two random tetrahedra. The second is shifted so that about a third of such pairs overlap.
std::pair<Corners, Corners> near_pair(Random& random);

/// A random vector perpendicular to `axis`, not of unit length.
Eigen::Vector3d across(Random& random, const Eigen::Vector3d& axis);

/// Touching tetrahedra on both sides of the plane x = 0, with integer coordinates up to 8. `level_a` and
/// `level_b` of their corners (1 corner, 2 edge, 3 face) are in the plane and contain the origin. Their
/// images under an injective affine map touch too.
std::pair<Corners, Corners> touching_integers(Random& random, unsigned level_a, unsigned level_b);

/// An integer matrix with entries up to 2^bits, bits <= 19, and |determinant| >= `least_stretch`.
Eigen::Matrix3d integer_map(Random& random, int bits, double least_stretch = 1);

Corners mapped(const Eigen::Matrix3d& map, const Corners& corners, const Eigen::Vector3d& by);

/// Unit in the last place of floats in the binade [2^k, 2^(k+1)) of `x` > 0: 2^(k - 23).
double float_unit(double x);

} // namespace tandem::hard
