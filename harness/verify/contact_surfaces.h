// SPDX-License-Identifier: MIT
#pragma once

#include "harness/verify/oracle/world.h"
#include "scenes/contact.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tandem {

/// The corners of polygons of equal pressure, one polygon after the other.
struct ContactSurfaces {
    std::vector<std::array<double, 3>> corners; ///< in world coordinates
    std::vector<double> pressures;              ///< at the corners
    std::vector<std::uint64_t> ends;            ///< polygon i has corners ends[i - 1] (or 0) to ends[i] - 1
};

/// The corners of rows of contact_rule=pressure, computed again on the host with the arithmetic of their
/// cell, in parallel. `world`: the corners of tetrahedra relative to `origin`, as the cell has them. Requires
/// rows of this frame.
ContactSurfaces surfaces_of(const Scene& scene, const oracle::World& world, Precision precision,
                            const std::array<double, 3>& origin, std::span<const ContactPoint> rows);

} // namespace tandem
