// SPDX-License-Identifier: MIT
// The opposing face of a pair, for the serial reference of rules whose normal is that of a boundary face of
// A.
#pragma once

#include "algorithms/narrow_phase/reference_pair.h"

namespace tandem::narrow_phase {

/// The boundary face of A that opposes one of B most; empty unless both have boundary faces.
template<class Real>
std::optional<unsigned> opposing(const ReferencePair<Real>& pair, const Boundaries& boundaries) {
    std::optional<unsigned> best;
    Real least = 0;
    for (unsigned a = 0; a < 4; ++a)
        for (unsigned b = 0; b < 4; ++b) {
            if ((boundaries[0] & 1u << a) == 0 || (boundaries[1] & 1u << b) == 0) continue;
            const Real value = dot(pair.solids[0].normals[a], pair.solids[1].normals[b]);
            if (best && value >= least) continue;
            best = a;
            least = value;
        }
    return best;
}

/// The points within half of A's height over the face, minus `margin`.
template<class Real>
std::vector<Contact<Real>> kept(const ReferencePair<Real>& pair, unsigned face,
                                const std::vector<SharedPoint<Real>>& points, Real margin) {
    std::vector<Contact<Real>> result;
    const auto& a = pair.solids[0];
    const Real within = std::abs(a.distance(face, a.corners[face])) / 2 - margin;
    for (const auto& shared : points) {
        const Real depth = a.distance(face, shared.point);
        if (std::abs(depth) < within) result.push_back(pair.contact(shared, a.normals[face], depth));
    }
    return result;
}

} // namespace tandem::narrow_phase
