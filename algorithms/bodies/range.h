// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/scene.h"

#include <span>

namespace tandem {

/// The largest magnitude of coordinates, before and after the transform, for which no sum along a direction
/// overflows: three terms of one transformed vertex, each a sum of four products with |entries| <= 1.
double largest_coordinate(Precision precision);

/// Throws InputError that names the first body of `frame` with a coordinate that is not finite or exceeds
/// largest_coordinate.
void check_range(const Scene& scene, const Frame& frame, Precision precision);

/// The same for these bodies and all fixed ones.
void check_range_of(const Scene& scene, const Frame& frame, Precision precision,
                    std::span<const std::uint32_t> bodies);

} // namespace tandem
