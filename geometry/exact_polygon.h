// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"

#include <array>
#include <optional>

namespace tandem {

/// A polygon on which the linear pressures of two tetrahedra are equal; each number is rounded once or twice.
struct ExactPolygon {
    double area = 0;                  ///< in squared units of the coordinates
    std::array<double, 3> centroid{}; ///< in the units of the coordinates
    std::array<double, 3> normal{};   ///< along the gradient of A's pressure minus that of B's; of length 1
    double pressure = 0;              ///< at the centroid
};

/// The polygon of equal pressure by rule pressure (algorithms/narrow_phase/rules/pressure.clh), in rationals.
/// `of_a`, `of_b`: pressures at the corners. No value where there is no polygon with an area, where a
/// tetrahedron is flat, or where a number is not finite.
std::optional<ExactPolygon> exact_polygon(const TetraCorners& a, const std::array<double, 4>& of_a,
                                          const TetraCorners& b, const std::array<double, 4>& of_b);

} // namespace tandem
