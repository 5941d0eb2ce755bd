// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "geometry/decision.h"
#include "scenes/scene.h"

#include <vector>

namespace tandem::oracle {

/// Corners of all tetrahedra of every body.
using World = std::vector<std::vector<TetraCorners>>;

/// The corners that world_vertices() has in this precision and with this origin, converted to double, which
/// is exact.
World world_of(const Scene& scene, const Frame& frame, Precision precision, Origin origin);

} // namespace tandem::oracle
