// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_corners.h"

namespace tandem::narrow_phase {

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

TANDEM_REFERENCE_OF(vertex)

} // namespace tandem::narrow_phase
