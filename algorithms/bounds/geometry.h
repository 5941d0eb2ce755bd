// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/table.h"
#include "backends/device.h"

#include <span>

namespace tandem {

/// The settings that determine the set of candidate pairs of a frame. Cells with equal geometry must give the
/// same set. Cells with different geometry, such as published and safe rounding, are never compared.
struct Geometry {
    int k = 18;                   ///< planes of a k-DOP: 6, 8, 12, 14, 16, 18, 20, 24 or 26
    bool coordinate_axes = false; ///< k = 8 only: x, y, z and one diagonal instead of the four cube diagonals
    Precision precision = Precision::fp32;    ///< of vertices, slabs and contacts
    Rounding rounding = Rounding::safe;       ///< of the ends of slabs
    Placement placement = Placement::rounded; ///< exact only with safe or directed rounding
    Origin origin = Origin::world;            ///< of coordinates on devices
    Motion motion = Motion::none;             ///< linear not with published rounding
    double margin = 0;                        ///< 0 with published rounding
    bool pressures = false;                   ///< vertices on devices carry the mesh's pressures
    bool pressure_slab = false;               ///< nodes have a slab of pressures; only with these

    /// Whether all members are equal.
    bool operator==(const Geometry&) const = default;
};

/// The ends of slabs of a node on devices: k, and two of the slab of pressures.
inline int ends_of_node(const Geometry& geometry) { return geometry.k + (geometry.pressure_slab ? 2 : 0); }

/// The k / 2 integer directions of a geometry, with components in {-1, 0, 1}, in the order of kernels.
std::vector<std::array<int, 3>> directions(const Geometry& geometry);

/// The settings that algorithms with k-DOPs declare: k, axes, precision, rounding, placement, origin,
/// motion, margin and pressure_slab.
std::span<const Parameter* const> geometry_parameters();

/// The geometry of these settings; with placement=exact and precision=double, origin is world. Throws
/// InputError if axes does not fit k, or placement, motion or margin does not fit rounding.
Geometry geometry_of(const Settings& settings);

/// Defines for kernels that read rows only (rows.clh): precision, placement, motion and group size.
Defines row_defines(const Geometry& geometry, std::uint32_t group_size);

/// Defines for kernels that use bounds: the whole geometry and the group size.
Defines geometry_defines(const Geometry& geometry, std::uint32_t group_size);

/// Reals of a pose on devices (body.clh).
inline std::size_t pose_reals(const Geometry& geometry) {
    return geometry.placement == Placement::exact || geometry.motion == Motion::linear ? 16 : 12;
}

/// The length by which kernels enlarge bounds in all directions: half the margin, rounded up, with a spare
/// factor for the roundings that follow (README.md, corollary 9). 0 without a margin.
float reach_of_margin(const Geometry& geometry);

/// Bytes of one real number.
inline std::size_t real_bytes(const Geometry& geometry) {
    return geometry.precision == Precision::fp64 ? 8 : 4;
}

} // namespace tandem
