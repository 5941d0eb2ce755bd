// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/scene.h"

namespace tandem {

/// The largest magnitude of a coordinate, before and after the transform, at which no sum along a direction
/// overflows (three terms of one transformed vertex, each a sum of four products with |entries| <= 1).
double largest_coordinate(Precision precision);

/// Throws InputError that names the first body of `frame` with a coordinate beyond largest_coordinate, or
/// that is not finite.
void check_range(const Scene& scene, const Frame& frame, Precision precision);

} // namespace tandem
