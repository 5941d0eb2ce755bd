// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/export/json_points.h"
#include "scenes/export/surfaces.h"

namespace tandem::exporting {

/// Bytes of contact surfaces in the JSON, before base64.
std::size_t surface_bytes(const SurfaceFrames& frame);

/// The contact surfaces of the frames of a page.
class GeometrySurfaces {
public:
    /// Takes those of the next frame: the largest polygons, up to `most_bytes`.
    void add(const SurfaceFrames& found, std::size_t most_bytes);

    /// Adds `surfaces` and `most_pressure`, and a note if polygons are left out.
    void write(OrderedJson& json, OrderedJson& notes) const;

private:
    struct Shown {
        std::size_t found = 0;
        std::vector<std::uint8_t> corners; ///< by polygon
        Points points;
        std::vector<double> pressures;
    };
    std::vector<Shown> frames_;
};

} // namespace tandem::exporting
