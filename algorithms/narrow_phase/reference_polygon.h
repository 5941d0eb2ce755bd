// SPDX-License-Identifier: MIT
// The polygon of equal pressure of a pair, in the serial reference of rule pressure.
#pragma once

#include "algorithms/narrow_phase/reference_pair.h"

namespace tandem::narrow_phase {

/// Local, as seen from the first tetrahedron; no corners where there is no polygon.
template<class Real>
struct PressurePolygon {
    std::vector<Vector<Real>> corners; ///< distinct, in the order of the polygon
    std::vector<Real> pressures;       ///< at the corners, not scaled
    Vector<Real> centroid{}, normal{};
    Real area = 0;     ///< in local units
    Real pressure = 0; ///< at the centroid, not scaled
};

/// `pair`: loaded, in canonical order. Defined in rules/pressure.cpp.
template<class Real>
PressurePolygon<Real> pressure_polygon(const ReferencePair<Real>& pair);

} // namespace tandem::narrow_phase
