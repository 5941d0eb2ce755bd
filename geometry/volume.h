// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"

#include <span>

namespace tandem {

/// Whether the tetrahedron has a volume, exactly: its corners lie in no common plane. Coordinates must be
/// finite. A filter of doubles first, integers where it is unsure.
bool has_volume(const TetraCorners& corners);

/// Volume of the convex hull of finite points, in their units cubed: exact, rounded once; 0 for points in a
/// common plane and for none. Points are added one after the other to a hull of triangles, those that see a
/// triangle from outside taking its place; every side is decided in integers, so that points in the plane of
/// a face do no harm.
double hull_volume(std::span<const std::array<double, 3>> points);

} // namespace tandem
