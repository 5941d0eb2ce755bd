// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/narrow_phase/contact_settings.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace tandem {

/// The corners of a tetrahedron in world coordinates, in either orientation.
template<class Real>
using Corners = std::array<std::array<Real, 3>, 4>;

/// A point where two tetrahedra touch. `feature`: 0..3 corner of A in B; 4..7 corner of B in A; 8 + 4 edge +
/// face: A's edge through B's face; 32 + 4 edge + face: B's edge through A's face. Edges are 01 02 03 12 13
/// 23; a face has the number of the opposite corner. With rule consistent it is the edge's inner end and the
/// face that gives the normal.
template<class Real>
struct Contact {
    unsigned feature = 0;
    std::array<Real, 3> point{};
    /// Unit vector out of A. All contacts of a pair have the same one, except with rules vertex and
    /// consistent.
    std::array<Real, 3> normal{};
    /// Negative inside. Signed distance from the face that gives the normal with rules opposing, published,
    /// vertex and consistent; depth of the pair with the others.
    Real depth = 0;

    bool operator==(const Contact&) const = default;
};

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

/// The two terms that a contact adds to the order-free digest; tetrahedra in input order.
template<class Real>
std::pair<std::uint64_t, std::uint64_t> contact_terms(std::uint32_t body_a, std::uint32_t tet_a,
                                                      std::uint32_t body_b, std::uint32_t tet_b,
                                                      const Contact<Real>& contact);

} // namespace tandem
