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

/// A point where two tetrahedra touch. `feature`: 0..3 corner of A in B, 4..7 corner of B in A,
/// 8 + 4 edge + face: A's edge through B's face, 32 + 4 edge + face: B's edge through A's face, with edges
/// 01 02 03 12 13 23 and a face named by the corner opposite it. Of rule consistent the edge's inner end,
/// with the face that gives the normal.
template<class Real>
struct Contact {
    unsigned feature = 0;
    std::array<Real, 3> point{};
    /// Unit, out of A; the same for all contacts of a pair but by rules vertex and consistent.
    std::array<Real, 3> normal{};
    /// Negative inside. Signed distance from the face that gives the normal by rules opposing, published,
    /// vertex and consistent, of the pair by the others.
    Real depth = 0;

    bool operator==(const Contact&) const = default;
};

/// Pairs that gave no contact, by reason, and what the stages of the decision left open.
struct ContactCounts {
    std::uint64_t degenerate = 0;          ///< no certain volume, or a coordinate that is no usable number
    std::uint64_t rejected = 0;            ///< told apart
    std::uint64_t undecided_by_filter = 0; ///< by the certified filter left open
    std::uint64_t undecided_by_double = 0; ///< by double left open

    bool operator==(const ContactCounts&) const = default;
};

/// The contacts of one pair in ascending order of feature, by the arithmetic of contacts.cl but none of its
/// code: equal to the kernel's bit by bit. Flat pairs that meet are degenerate. Bit i of `boundary_a`: the
/// face opposite corner i of A is on its mesh's boundary. Real is float or double.
template<class Real>
std::vector<Contact<Real>> reference_contacts(const Corners<Real>& a, const Corners<Real>& b,
                                              unsigned boundary_a, unsigned boundary_b, ContactCounts& counts,
                                              const ContactSettings& settings = {});

/// The two terms a contact adds to the order-free digest; tetrahedra in input order.
template<class Real>
std::pair<std::uint64_t, std::uint64_t> contact_terms(std::uint32_t body_a, std::uint32_t tet_a,
                                                      std::uint32_t body_b, std::uint32_t tet_b,
                                                      const Contact<Real>& contact);

} // namespace tandem
