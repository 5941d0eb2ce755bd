// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/contact.h"
#include "scenes/scene.h"

#include <span>
#include <vector>

namespace tandem::python {

/// Those of the pairs whose closed tetrahedra have a common point in the frame, in the same order. The
/// decision is exact for the vertices as a device has them: moved and rounded in the geometry's precision,
/// relative to `origin`. Runs on all cores. Throws InputError for placement=exact, whose vertices have no
/// such numbers.
std::vector<Pair> meeting_of(const Scene& scene, const Frame& frame, const Geometry& geometry,
                             const Eigen::Vector3d& origin, std::span<const Pair> pairs);

} // namespace tandem::python
