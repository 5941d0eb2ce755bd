// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/contact_digest.h"
#include "algorithms/narrow_phase/contact_settings.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tandem {

/// The corners of a tetrahedron in world coordinates, in either orientation.
template<class Real>
using Corners = std::array<std::array<Real, 3>, 4>;

/// Pairs without contacts, by reason, and pairs that the stages of the decision leave open.
struct ContactCounts {
    std::uint64_t degenerate = 0;          ///< no certain volume, or an unusable coordinate
    std::uint64_t rejected = 0;            ///< found apart
    std::uint64_t undecided_by_filter = 0; ///< left open by the certified filter
    std::uint64_t undecided_by_double = 0; ///< left open by double
    std::uint64_t without_boundary = 0;    ///< lack boundary faces that the rule needs; in no other count

    bool operator==(const ContactCounts&) const = default;
};

/// The contacts of one pair in ascending order of feature. They equal the kernel's bit by bit: this function
/// uses the arithmetic of contacts.cl, but none of its code. Flat pairs that meet are degenerate. Bit i of
/// `boundary_a`: the face opposite corner i of A is on its mesh's boundary. Real is float or double.
template<class Real>
std::vector<Contact<Real>> reference_contacts(const Corners<Real>& a, const Corners<Real>& b,
                                              unsigned boundary_a, unsigned boundary_b, ContactCounts& counts,
                                              const ContactSettings& settings = {});

} // namespace tandem
