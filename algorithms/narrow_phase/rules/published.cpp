// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_faces.h"

namespace tandem::narrow_phase {

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

TANDEM_REFERENCE_OF(published)

} // namespace tandem::narrow_phase
