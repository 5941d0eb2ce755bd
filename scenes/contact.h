// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

namespace tandem {

/// Two tetrahedra whose leaf k-DOPs overlap, numbered in input order; body_a < body_b.
struct Pair {
    std::uint32_t body_a = 0, ///< number in the whole scene, from 0
        tet_a = 0,            ///< index into the tetrahedra of its mesh
        body_b = 0,           ///< number in the whole scene, from 0
        tet_b = 0;            ///< index into the tetrahedra of its mesh

    /// Orders by body_a, tet_a, body_b, tet_b.
    auto operator<=>(const Pair&) const = default;
};

/// A contact between a pair: point and normal (out of body a) in world coordinates, depth < 0 inside. Of a
/// rule that measures distances: the point of a that is closest to b, the normal towards b's, and the
/// distance. Of rule pressure: the centroid of the polygon of equal pressure, the normal into body a, the
/// area, and the pressure.
struct ContactPoint {
    Pair pair;                     ///< the two tetrahedra
    std::uint32_t feature = 0;     ///< number defined by algorithms/narrow_phase
    std::array<double, 3> point{}, ///< x, y, z, in the scene's unit of length
        normal{};                  ///< x, y, z; of length 1, within rounding
    double depth = 0;              ///< in the scene's unit of length; an area in its square
    double pressure = 0;           ///< at the centroid; 0 with other rules
};

/// The corners of polygons of equal pressure, one polygon after the other.
struct ContactSurfaces {
    std::vector<std::array<double, 3>> corners; ///< in world coordinates
    std::vector<double> pressures;              ///< at the corners
    std::vector<std::uint64_t> ends;            ///< polygon i has corners ends[i - 1] (or 0) to ends[i] - 1
};

/// The point of b, where the contact rule measures distances.
inline std::array<double, 3> other_point(const ContactPoint& contact) {
    auto point = contact.point;
    for (std::size_t i = 0; i < 3; ++i) point[i] += contact.normal[i] * contact.depth;
    return point;
}

} // namespace tandem
