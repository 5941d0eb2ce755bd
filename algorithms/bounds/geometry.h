// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/table.h"
#include "backends/device.h"

#include <span>

namespace tandem {

/// What fixes the set of candidate pairs of a frame: cells that agree in it must give the same set, and only
/// those are ever compared. Published rounding thus stands beside others, never against them.
struct Geometry {
    int k = 18;
    bool coordinate_axes = false; ///< k = 8 only: x, y, z and one diagonal instead of the four cube diagonals
    Precision precision = Precision::fp32;
    Rounding rounding = Rounding::safe;
    Placement placement = Placement::rounded;
    Origin origin = Origin::world;

    bool operator==(const Geometry&) const = default;
};

/// The integer directions of a geometry, as rows of {-1, 0, 1}; k / 2 of them, in the kernels' order.
std::vector<std::array<int, 3>> directions(const Geometry& geometry);

/// Settings k, axes, precision, rounding, placement and origin: those an algorithm with k-DOPs declares.
std::span<const Parameter* const> geometry_parameters();

/// Throws InputError when axes does not fit k, placement not rounding, or origin not placement.
Geometry geometry_of(const Settings& settings);

/// What kernels need that read rows only (rows.clh): precision and placement as defines, with the group size.
Defines row_defines(const Geometry& geometry, std::uint32_t group_size);

/// The whole geometry as defines, with the group size.
Defines geometry_defines(const Geometry& geometry, std::uint32_t group_size);

/// Reals of a pose on devices: body.clh.
inline std::size_t pose_reals(const Geometry& geometry) {
    return geometry.placement == Placement::exact ? 16 : 12;
}

/// Bytes of one real number.
inline std::size_t real_bytes(const Geometry& geometry) {
    return geometry.precision == Precision::fp64 ? 8 : 4;
}

} // namespace tandem
