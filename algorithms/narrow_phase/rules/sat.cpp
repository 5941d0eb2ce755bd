// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_axes.h"

namespace tandem::narrow_phase {

template<class Real>
std::vector<Contact<Real>> sat_contacts(const ReferencePair<Real>& pair, const Boundaries&) {
    const auto [normal, overlap] = least_translation(pair, all_faces);
    return contacts_along(pair, normal, -overlap);
}

TANDEM_REFERENCE_OF(sat)

} // namespace tandem::narrow_phase
