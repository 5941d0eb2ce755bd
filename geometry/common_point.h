// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"

#include <optional>

namespace tandem::geometry {

/// About the middle of the intersection of two tetrahedra, in double without a bound. No value when there
/// seems to be no intersection. Corners of an intersection are on edges of either tetrahedron, so that the
/// edges' parts inside the other one have all of them as ends (Liang and Barsky 1984).
std::optional<std::array<double, 3>> common_point(const TetraCorners& a, const TetraCorners& b);

} // namespace tandem::geometry
