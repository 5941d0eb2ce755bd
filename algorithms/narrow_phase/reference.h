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
    std::uint64_t rejected = 0;            ///< found apart; by rule pressure: without a polygon
    std::uint64_t undecided_by_filter = 0; ///< left open by the certified filter
    std::uint64_t undecided_by_double = 0; ///< left open by double
    std::uint64_t without_boundary = 0;    ///< lack boundary faces that the rule needs; in no other count

    bool operator==(const ContactCounts&) const = default;
};

/// A tetrahedron as the reference gets it, in the precision of the contact stage.
template<class Real>
struct GivenTetrahedron {
    Corners<Real> corners;           ///< in world coordinates
    unsigned boundary = 15;          ///< bit i: the face opposite corner i is on its mesh's boundary
    std::array<Real, 4> pressures{}; ///< at the corners; read by rules that need them
};

/// The contacts of one pair in ascending order of feature. They equal the kernel's bit by bit: this function
/// uses the arithmetic of contacts.cl, but none of its code. Flat pairs that meet are degenerate. Real is
/// float or double.
template<class Real>
std::vector<Contact<Real>> reference_contacts(const GivenTetrahedron<Real>& a,
                                              const GivenTetrahedron<Real>& b, ContactCounts& counts,
                                              const ContactSettings& settings = {});

/// The corners of a polygon, in its order, in world coordinates, and the pressures there.
template<class Real>
struct PolygonCorners {
    std::vector<std::array<Real, 3>> points;
    std::vector<Real> pressures;
};

/// The polygon of a pair by rule pressure; no corners where reference_contacts() with that rule makes no row
/// of a pair that meets.
template<class Real>
PolygonCorners<Real> polygon_of_equal_pressure(const GivenTetrahedron<Real>& a,
                                               const GivenTetrahedron<Real>& b);

} // namespace tandem
