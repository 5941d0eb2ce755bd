// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace tandem {

/// Pairs without contacts, by reason.
struct ContactCounts {
    std::uint64_t degenerate =
        0; ///< a tetrahedron's volume cannot be told from zero, or a coordinate is not finite
    std::uint64_t rejected = 0; ///< a separating axis tells the tetrahedra apart
};

/// A contact in world coordinates; depth < 0 inside a. Features as README.md here numbers them.
template<class Real>
struct Contact {
    unsigned feature = 0;
    std::array<Real, 3> point{}, normal{};
    Real depth = 0;
};

template<class Real>
using Corners = std::array<std::array<Real, 3>, 4>;

/// The contacts of two tetrahedra in order of their features; bit i of `boundary` flags the face opposite
/// corner i. Serial code that shares nothing with the kernel but its arithmetic, so that results have equal
/// bits. Float and double.
template<class Real>
std::vector<Contact<Real>> reference_contacts(const Corners<Real>& a, const Corners<Real>& b,
                                              unsigned boundary_a, unsigned boundary_b,
                                              ContactCounts& counts);

/// The two terms of a contact in the digest; tetrahedra in input order.
template<class Real>
std::pair<std::uint64_t, std::uint64_t> contact_terms(std::uint32_t body_a, std::uint32_t tet_a,
                                                      std::uint32_t body_b, std::uint32_t tet_b,
                                                      const Contact<Real>& contact);

} // namespace tandem
