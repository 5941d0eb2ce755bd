// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/scene.h"

namespace tandem {

/// The largest magnitude of coordinates, before and after the transform, for which no sum along a direction
/// overflows: three terms of one transformed vertex, each a sum of four products with |entries| <= 1. Where
/// vertices have pressures, the area of a polygon does not overflow either.
double largest_coordinate(const Geometry& geometry);

/// The smallest extent of a mesh with pressures: areas down to 2^-46 of its square are normal numbers in
/// float.
double smallest_extent(Precision precision);

/// The smallest largest pressure of a mesh: pressures of its vertices keep their digits down to 2^-23 of it.
double smallest_pressure(Precision precision);

/// Throws InputError that names the first body of `frame` with a coordinate that is not finite or exceeds
/// largest_coordinate.
void check_range(const Scene& scene, const Frame& frame, const Geometry& geometry);

/// The same for the translation or vertices of one body, without its mesh.
void check_range_of(const Scene& scene, const Frame& frame, const Geometry& geometry, std::size_t body);

} // namespace tandem
