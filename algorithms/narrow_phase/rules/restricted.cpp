// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_axes.h"

namespace tandem::narrow_phase {

template<class Real>
std::vector<Contact<Real>> restricted_contacts(const ReferencePair<Real>& pair,
                                               const Boundaries& boundaries) {
    if (boundaries == Boundaries{}) return {};
    const auto [normal, overlap] = least_translation(pair, boundaries);
    return contacts_along(pair, normal, -overlap);
}

TANDEM_REFERENCE_OF(restricted)

} // namespace tandem::narrow_phase
