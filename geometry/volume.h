// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"

#include <span>

namespace tandem {

/// Whether the tetrahedron has volume, exactly: its corners do not lie in one plane. Coordinates must be
/// finite. A filter in double runs first; integers decide when it is uncertain.
bool has_volume(const TetraCorners& corners);

/// Volume of the convex hull of finite points, in their units cubed: exact, rounded once. 0 for no points and
/// for points in one plane. Points are added one by one to a hull of triangles and replace the triangles that
/// face them. Integers decide every side, so points in the plane of a face are valid.
double hull_volume(std::span<const std::array<double, 3>> points);

} // namespace tandem
