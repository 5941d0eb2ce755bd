// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/hard/hard.h"

namespace tandem::hard {

using Corners = std::array<Eigen::Vector3d, 4>;

/// Uniform over the integers low..high.
int whole(Random& random, int low, int high);

/// x as the float it is already; throws std::logic_error when it is none: a construction that claims to be
/// exact must be.
float exact(double x);

/// The pair of these corners, shuffled; every coordinate must be a float.
HardPair exact_pair(Random& random, const Corners& a, const Corners& b, Known known = Known::open);

/// The same with coordinates rounded to the nearest floats.
HardPair rounded_pair(Random& random, const Corners& a, const Corners& b, Known known = Known::open);

Corners moved(Corners corners, const Eigen::Vector3d& by);
Corners scaled(Corners corners, double by);

/// Six times the signed volume; exact for small integers.
double determinant(const Corners& corners);

/// A random tetrahedron in the cube of side 2 about the origin, not flat.
Corners random_tetrahedron(Random& random);

/// Two of them, the second shifted so that about a third of such pairs meet.
std::pair<Corners, Corners> near_pair(Random& random);

/// Any vector across `axis`, not of unit length.
Eigen::Vector3d across(Random& random, const Eigen::Vector3d& axis);

/// Tetrahedra on both sides of the plane x = 0, of integers up to 8, with `level_a` and `level_b` (1 corner,
/// 2 edge, 3 face) of their corners in it and the origin inside those: they touch, as any image under an
/// injective affine map does.
std::pair<Corners, Corners> touching_integers(Random& random, unsigned level_a, unsigned level_b);

/// An integer matrix with entries up to 2^bits, bits <= 19, of determinant at least 1, or at least
/// `least_stretch`.
Eigen::Matrix3d integer_map(Random& random, int bits, double least_stretch = 1);

Corners mapped(const Eigen::Matrix3d& map, const Corners& corners, const Eigen::Vector3d& by);

/// The unit of floats in [2^k, 2^(k+1)) that holds `x` > 0: 2^(k - 23).
double float_unit(double x);

} // namespace tandem::hard
