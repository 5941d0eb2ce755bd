// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"

#include <optional>

namespace tandem {

/// The distance of two tetrahedra that do not meet, in the units of the coordinates: the least over their
/// edges, and over corners and the faces below them, in rationals; rounded once, to the nearest double. No
/// value if they meet, or if a coordinate is not finite.
std::optional<double> exact_distance(const TetraCorners& a, const TetraCorners& b);

} // namespace tandem
