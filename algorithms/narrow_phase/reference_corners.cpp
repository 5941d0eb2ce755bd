// SPDX-License-Identifier: MIT
// Rules vertex and consistent, which make contacts of corners inside the other tetrahedron.
#include "algorithms/narrow_phase/reference_pair.h"

namespace tandem::contact_reference {

namespace {

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

/// One contact for each corner inside the other tetrahedron, with the boundary face whose plane is nearest.
template<class Real>
std::vector<Contact<Real>> vertex_contacts(const ReferencePair<Real>& pair, const Boundaries& boundaries) {
    std::vector<Contact<Real>> result;
    for (unsigned owner = 0; owner < 2; ++owner)
        for (unsigned corner = 0; corner < 4; ++corner) {
            if ((corners_inside(pair, owner) & 1u << corner) == 0) continue;
            std::array<std::optional<Real>, 4> below;
            for (unsigned face = 0; face < 4; ++face)
                if ((boundaries[1 - owner] & 1u << face) != 0)
                    below[face] = -pair.solids[1 - owner].distance(face, pair.solids[owner].corners[corner]);
            if (const auto face = least(below))
                result.push_back(contact_with(pair, 4 * owner + corner, owner, corner, *face));
        }
    return result;
}

/// One contact for each edge that leaves the other tetrahedron through a boundary face, at its inner corner.
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

template std::vector<Contact<float>> vertex_contacts(const ReferencePair<float>&, const Boundaries&);
template std::vector<Contact<double>> vertex_contacts(const ReferencePair<double>&, const Boundaries&);
template std::vector<Contact<float>> consistent_contacts(const ReferencePair<float>&, const Boundaries&);
template std::vector<Contact<double>> consistent_contacts(const ReferencePair<double>&, const Boundaries&);

} // namespace tandem::contact_reference
