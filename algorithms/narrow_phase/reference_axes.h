// SPDX-License-Identifier: MIT
// Candidate axes of a pair, for the serial reference of rules with one normal and one depth per pair.
#pragma once

#include "algorithms/narrow_phase/reference_pair.h"

namespace tandem::narrow_phase {

/// The best axis so far: the one with the least measure.
template<class Real>
struct Best {
    Vector<Real> normal{};
    Real measure = std::numeric_limits<Real>::infinity();

    void consider(const Vector<Real>& n, Real value) {
        if (value < measure) *this = {n, value};
    }
};

/// Calls visit with the unit normals of faces, out of A, and the unit cross products of edges. Only boundary
/// faces and their edges count.
template<class Real, class Visit>
void for_each_axis(const ReferencePair<Real>& pair, const Boundaries& boundaries, Visit visit) {
    const auto has_edge = [&](unsigned solid, unsigned edge) {
        for (unsigned face = 0; face < 4; ++face)
            if ((boundaries[solid] & 1u << face) != 0 && face != edge_ends[edge][0]
                && face != edge_ends[edge][1])
                return true;
        return false;
    };
    for (unsigned solid = 0; solid < 2; ++solid)
        for (unsigned face = 0; face < 4; ++face)
            if ((boundaries[solid] & 1u << face) != 0)
                visit(pair.solids[solid].normals[face] * Real(solid == 0 ? 1 : -1));
    for (unsigned p = 0; p < 6; ++p)
        for (unsigned q = 0; q < 6; ++q) {
            if (!has_edge(0, p) || !has_edge(1, q)) continue;
            const auto& [i, j] = edge_ends[p];
            const auto& [k, l] = edge_ends[q];
            const auto n = cross((pair.world[0][j] - pair.world[0][i]) * pair.scale,
                                 (pair.world[1][l] - pair.world[1][k]) * pair.scale);
            if (largest(n) >= ReferencePair<Real>::shortest) visit(unit(n));
        }
}

/// For rules that use every face of a tetrahedron, whatever its mesh.
constexpr Boundaries all_faces{15, 15};

/// The axis with the least translation as its measure. Without boundary faces there is no axis, and the
/// measure is infinite.
template<class Real>
Best<Real> least_translation(const ReferencePair<Real>& pair, const Boundaries& boundaries) {
    Best<Real> best;
    for_each_axis(pair, boundaries, [&](const Vector<Real>& n) {
        const auto [low_a, high_a, low_b, high_b] = pair.extents(n);
        best.consider(n, high_a - low_b);
        best.consider(n * Real(-1), high_b - low_a);
    });
    return best;
}

/// A contact at every shared point, each with this normal and depth.
template<class Real>
std::vector<Contact<Real>> contacts_along(const ReferencePair<Real>& pair, const Vector<Real>& normal,
                                          Real depth) {
    std::vector<Contact<Real>> result;
    for (const auto& shared : pair.shared_points()) result.push_back(pair.contact(shared, normal, depth));
    return result;
}

} // namespace tandem::narrow_phase
