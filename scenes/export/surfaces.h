// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"

#include <span>
#include <string>

namespace tandem {

/// Contact surfaces of some frames.
struct SurfaceFrames {
    std::vector<std::uint32_t> frames; ///< by polygon
    std::vector<ContactPoint> rows;    ///< of contact_rule=pressure, by polygon
    ContactSurfaces surfaces;          ///< the corners of all polygons

    /// Appends the polygons of a frame.
    void add(std::uint32_t frame, std::span<const ContactPoint> more, const ContactSurfaces& corners);
};

/// The text of a .vtp file of polygons in double: point data pressure; cell data pressure (at the centroid),
/// normal, area, frame, and the numbers of bodies and tetrahedra.
std::string surfaces_vtp(const SurfaceFrames& all);

} // namespace tandem
