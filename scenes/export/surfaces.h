// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/scene.h"

#include <functional>
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

    /// The largest pressure at a corner; 0 without polygons.
    double most_pressure() const;
};

/// Returns the contact surfaces of a frame, given with its number.
using FindSurfaces = std::function<SurfaceFrames(std::size_t, const Frame&)>;

/// The text of a .vtp file of polygons in double: point data pressure; cell data pressure (at the centroid),
/// normal, area, frame, and the numbers of bodies and tetrahedra.
std::string surfaces_vtp(const SurfaceFrames& all);

} // namespace tandem
