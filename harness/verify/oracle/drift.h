// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/scene.h"

namespace tandem {

/// How far a frame's world vertices, as a cell of some precision has them (placement=rounded), are from where
/// the poses put the scene's own vertices exactly (placement=exact). A vertex's drift is its largest along an
/// axis, in ulps of its largest coordinate: spacings of the precision's numbers there.
struct Drift {
    std::uint64_t vertices = 0;          ///< of all bodies
    double median = 0, p99 = 0, max = 0; ///< ulps, as of `Spread`
    double of_bound = 0; ///< the largest share of its drift_bound that a vertex uses along an axis; at most 1
};

/// Exact: rationals, rounded once for each vertex. On all cores; about 10 us a vertex.
Drift vertex_drift(const Scene& scene, const Frame& frame, Precision precision);

} // namespace tandem
