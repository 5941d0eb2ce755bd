// SPDX-License-Identifier: MIT
// Corners inside the other tetrahedron, for the serial reference of rules that make contacts of them.
#pragma once

#include "algorithms/narrow_phase/reference_pair.h"

namespace tandem::narrow_phase {

/// The corner's contact with a face of the other tetrahedron; the normal points out of A.
template<class Real>
Contact<Real> contact_with(const ReferencePair<Real>& pair, unsigned feature, unsigned owner, unsigned corner,
                           unsigned face) {
    const auto& other = pair.solids[1 - owner];
    const auto& p = pair.solids[owner].corners[corner];
    return pair.contact({feature, p}, other.normals[face] * Real(owner == 0 ? -1 : 1),
                        other.distance(face, p));
}

/// The face with the least value, the first on ties; empty if no face has a value.
template<class Real>
std::optional<unsigned> least(const std::array<std::optional<Real>, 4>& values) {
    std::optional<unsigned> best;
    for (unsigned face = 0; face < 4; ++face)
        if (values[face] && (!best || *values[face] < *values[*best])) best = face;
    return best;
}

/// Bit i: corner i is inside the other tetrahedron.
template<class Real>
unsigned corners_inside(const ReferencePair<Real>& pair, unsigned owner) {
    unsigned inside = 0;
    for (unsigned corner = 0; corner < 4; ++corner)
        if (pair.inside(pair.solids[1 - owner], pair.solids[owner].corners[corner], 4, pair.tolerance()))
            inside |= 1u << corner;
    return inside;
}

} // namespace tandem::narrow_phase
