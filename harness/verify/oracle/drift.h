// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/scene.h"

#include <array>

namespace tandem {

/// drift_bound() of a rigid body on devices with this origin. `frame`: relative to the origin.
std::array<double, 3> drift_bound_of(const Scene& scene, const Frame& frame, std::size_t body,
                                     Precision precision, Origin origin);

/// Distance of a frame's world vertices in a cell's precision (placement=rounded) from the exactly posed
/// vertices of the scene (placement=exact). A vertex's drift is its largest distance along an axis, in ulps
/// of its largest coordinate.
struct Drift {
    std::uint64_t vertices = 0;          ///< of all bodies
    double median = 0, p99 = 0, max = 0; ///< in ulps, as in `Spread`
    double of_bound = 0; ///< the largest ratio of a distance along an axis to its drift_bound; at most 1
};

/// Computes with rationals and rounds once for each vertex. Runs on all cores; about 10 us a vertex.
Drift vertex_drift(const Scene& scene, const Frame& frame, Precision precision,
                   Origin origin = Origin::world);

} // namespace tandem
