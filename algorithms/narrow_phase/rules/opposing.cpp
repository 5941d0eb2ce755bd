// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_faces.h"

namespace tandem::narrow_phase {

template<class Real>
std::vector<Contact<Real>> opposing_contacts(const ReferencePair<Real>& pair, const Boundaries& boundaries) {
    const auto face = opposing(pair, boundaries);
    if (!face) return {};
    return kept(pair, *face, pair.shared_points(), Real(0));
}

TANDEM_REFERENCE_OF(opposing)

} // namespace tandem::narrow_phase
