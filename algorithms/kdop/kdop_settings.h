// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/settings.h"
#include "backends/device.h"

#include <span>

namespace tandem {

enum class Precision { single, twice };
/// How a slab's ends are rounded, in the order of directions.clh; README.md here has what each is good for.
enum class Rounding {
    nearest,   ///< to nearest, nothing added: misses pairs on directions with three non-zeros
    safe,      ///< widened where the rounding is not monotone: misses nothing
    published, ///< the paper's: unit directions, an absolute tolerance of 10 FLT_EPSILON; misses pairs
    directed   ///< outwards, on devices that can: slabs contain the exact ones
};
/// What counts as the position of a vertex.
enum class Truth {
    vertices, ///< T1: the world vertices in the cell's precision, after their transform has been rounded
    pose      ///< T2: the scene's own doubles, its poses and vertices, moved without rounding
};

/// What fixes the set of candidate pairs of a frame: cells that agree in it must give the same set, and only
/// those are ever compared. Published rounding thus stands beside others, never against them.
struct Geometry {
    int k = 18;
    bool coordinate_axes = false; ///< k = 8 only: x, y, z and one diagonal instead of the four cube diagonals
    Precision precision = Precision::single;
    Rounding rounding = Rounding::safe;
    Truth truth = Truth::vertices;

    bool operator==(const Geometry&) const = default;
};

/// The integer directions of a geometry, as rows of {-1, 0, 1}; k / 2 of them, in the kernels' order.
std::vector<std::array<int, 3>> directions(const Geometry& geometry);

/// Parameters k, axes, precision, rounding and truth.
std::span<const Parameter> geometry_parameters();

/// Throws InputError when axes does not fit k, or truth not rounding.
Geometry geometry_of(const Settings& settings);

/// What kernels need that read rows only (rows.clh): precision and truth as defines, with the group size.
Defines row_defines(const Geometry& geometry, std::uint32_t group_size);

/// The whole geometry as defines, with the group size.
Defines geometry_defines(const Geometry& geometry, std::uint32_t group_size);

/// Reals of a pose on devices: body.clh.
inline std::size_t pose_reals(const Geometry& geometry) { return geometry.truth == Truth::pose ? 16 : 12; }

/// Bytes of one real number.
inline std::size_t real_bytes(const Geometry& geometry) {
    return geometry.precision == Precision::twice ? 8 : 4;
}

} // namespace tandem
