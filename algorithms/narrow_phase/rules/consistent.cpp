// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_corners.h"

namespace tandem::narrow_phase {

namespace {

/// The boundary face of the other tetrahedron whose plane the edge from `inner` to `outer` crosses first.
template<class Real>
std::optional<unsigned> first_crossed(const ReferencePair<Real>& pair, unsigned owner, unsigned inner,
                                      unsigned outer, unsigned boundary) {
    std::array<std::optional<Real>, 4> fractions;
    for (unsigned face = 0; face < 4; ++face) {
        const Real from = pair.solids[1 - owner].distance(face, pair.solids[owner].corners[inner]);
        const Real to = pair.solids[1 - owner].distance(face, pair.solids[owner].corners[outer]);
        if ((boundary & 1u << face) != 0 && to > pair.tolerance()) fractions[face] = from / (from - to);
    }
    return least(fractions);
}

} // namespace

template<class Real>
std::vector<Contact<Real>> consistent_contacts(const ReferencePair<Real>& pair,
                                               const Boundaries& boundaries) {
    std::vector<Contact<Real>> result;
    for (unsigned owner = 0; owner < 2; ++owner) {
        const unsigned inside = corners_inside(pair, owner);
        for (unsigned edge = 0; edge < 6; ++edge) {
            const bool outward = (inside & 1u << edge_ends[edge][0]) != 0;
            const unsigned inner = edge_ends[edge][outward ? 0 : 1];
            const unsigned outer = edge_ends[edge][outward ? 1 : 0];
            if ((inside & 1u << inner) == 0 || (inside & 1u << outer) != 0) continue;
            if (const auto face = first_crossed(pair, owner, inner, outer, boundaries[1 - owner]))
                result.push_back(contact_with(pair, 8 + 24 * owner + 4 * edge + *face, owner, inner, *face));
        }
    }
    return result;
}

TANDEM_REFERENCE_OF(consistent)

} // namespace tandem::narrow_phase
