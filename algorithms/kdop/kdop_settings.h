// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/settings.h"
#include "backends/device.h"

#include <span>

namespace tandem {

enum class Precision { single, twice };
enum class Rounding { nearest, safe };

/// What fixes the set of candidate pairs of a frame: cells that agree in it must give the same set.
struct Geometry {
    int k = 18;
    bool coordinate_axes = false; ///< k = 8 only: x, y, z and one diagonal instead of the four cube diagonals
    Precision precision = Precision::single;
    Rounding rounding = Rounding::safe;

    bool operator==(const Geometry&) const = default;
};

/// The integer directions of a geometry, as rows of {-1, 0, 1}; k / 2 of them, in the kernels' order.
std::vector<std::array<int, 3>> directions(const Geometry& geometry);

/// Parameters k, axes, precision and rounding.
std::span<const Parameter> geometry_parameters();

/// Throws InputError when axes does not fit k.
Geometry geometry_of(const Settings& settings);

/// The geometry as kernel defines, with the group size.
Defines geometry_defines(const Geometry& geometry, std::uint32_t group_size);

/// Bytes of one real number.
inline std::size_t real_bytes(const Geometry& geometry) {
    return geometry.precision == Precision::twice ? 8 : 4;
}

} // namespace tandem
