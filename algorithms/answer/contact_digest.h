// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <utility>

namespace tandem {

/// A point where two tetrahedra touch. `feature`: 0..3 corner of A in B; 4..7 corner of B in A; 8 + 4 edge +
/// face: A's edge through B's face; 32 + 4 edge + face: B's edge through A's face. Edges are 01 02 03 12 13
/// 23; a face has the number of the opposite corner. With rule consistent it is the edge's inner end and the
/// face that gives the normal. Of rule pressure it is the number of a polygon's corners, and `point` its
/// centroid.
template<class Real>
struct Contact {
    unsigned feature = 0;
    std::array<Real, 3> point{};
    /// Unit vector out of A, with rule pressure into it. All contacts of a pair have the same one, except
    /// with rules vertex and consistent.
    std::array<Real, 3> normal{};
    /// Negative inside. Signed distance from the face that gives the normal with rules opposing, published,
    /// vertex and consistent; area of the polygon with pressure; depth of the pair with the others.
    Real depth = 0;
    Real pressure = 0; ///< at the centroid; 0 with rules other than pressure

    bool operator==(const Contact&) const = default;
};

/// The two terms that a contact adds to the order-free digest; tetrahedra in input order.
template<class Real>
std::pair<std::uint64_t, std::uint64_t> contact_terms(std::uint32_t body_a, std::uint32_t tet_a,
                                                      std::uint32_t body_b, std::uint32_t tet_b,
                                                      const Contact<Real>& contact);

} // namespace tandem
