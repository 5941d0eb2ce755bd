// SPDX-License-Identifier: MIT
// Rules opposing and published, whose normal is that of a boundary face of A.
#include "algorithms/narrow_phase/reference_pair.h"

namespace tandem::contact_reference {

namespace {

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

} // namespace

template<class Real>
std::vector<Contact<Real>> opposing_contacts(const ReferencePair<Real>& pair, const Boundaries& boundaries) {
    const auto face = opposing(pair, boundaries);
    if (!face) return {};
    return kept(pair, *face, pair.shared_points(), Real(0));
}

template<class Real>
std::vector<Contact<Real>> published_contacts(const ReferencePair<Real>& pair, const Boundaries& boundaries) {
    const auto face = opposing(pair, boundaries);
    if (!face) return {};
    const Real tolerance = 10 * std::ldexp(Real(1), -23) * pair.scale;
    std::vector<SharedPoint<Real>> points;
    for (unsigned owner = 0; owner < 2; ++owner)
        for (unsigned corner = 0; corner < 4; ++corner) {
            const auto& p = pair.solids[owner].corners[corner];
            bool clear = true;
            for (unsigned side = 0; side < 4; ++side)
                clear = clear && pair.solids[1 - owner].distance(side, p) < -tolerance;
            if (clear) points.push_back({4 * owner + corner, p});
        }
    for (unsigned edge = 0; edge < 6; ++edge)
        for (unsigned side = 0; side < 4; ++side) {
            const auto [ahead, behind] = pair.ends(1, edge, side);
            if (ahead * behind >= -(tolerance * pair.scale)) continue;
            const auto p = pair.crossing(1, edge, side);
            if (pair.inside(pair.solids[0], p, side, -tolerance)) points.push_back({32 + 4 * edge + side, p});
        }
    return kept(pair, *face, points, tolerance);
}

template std::vector<Contact<float>> opposing_contacts(const ReferencePair<float>&, const Boundaries&);
template std::vector<Contact<double>> opposing_contacts(const ReferencePair<double>&, const Boundaries&);
template std::vector<Contact<float>> published_contacts(const ReferencePair<float>&, const Boundaries&);
template std::vector<Contact<double>> published_contacts(const ReferencePair<double>&, const Boundaries&);

} // namespace tandem::contact_reference
