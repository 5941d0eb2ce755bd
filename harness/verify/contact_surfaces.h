// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "harness/verify/oracle/world.h"
#include "scenes/contact.h"

#include <span>

namespace tandem {

/// The corners of rows of contact_rule=pressure, computed again on the host with the arithmetic of their
/// cell, in parallel. `world`: the corners of tetrahedra relative to `origin`, as the cell has them. Requires
/// rows of this frame.
ContactSurfaces surfaces_of(const Scene& scene, const oracle::World& world, Precision precision,
                            const std::array<double, 3>& origin, std::span<const ContactPoint> rows);

/// The same for rows of a frame in the scene's coordinates, which a session with this geometry counted from
/// `origin`.
ContactSurfaces surfaces_of(const Scene& scene, const Frame& frame, const Geometry& geometry,
                            const std::array<double, 3>& origin, std::span<const ContactPoint> rows);

} // namespace tandem
