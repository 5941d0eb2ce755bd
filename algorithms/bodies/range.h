// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/scene.h"

namespace tandem {

/// The largest magnitude of coordinates, before and after the transform, for which no sum along a direction
/// overflows: three terms of one transformed vertex, each a sum of four products with |entries| <= 1.
double largest_coordinate(Precision precision);

/// Throws InputError that names the first body of `frame` with a coordinate that is not finite or exceeds
/// largest_coordinate.
void check_range(const Scene& scene, const Frame& frame, Precision precision);

/// The same for the translation or vertices of one body, without its mesh.
void check_range_of(const Scene& scene, const Frame& frame, Precision precision, std::size_t body);

} // namespace tandem
