// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <compare>
#include <cstdint>

namespace tandem {

/// Two tetrahedra whose leaf k-DOPs overlap, numbered in input order; body_a < body_b.
struct Pair {
    std::uint32_t body_a = 0, tet_a = 0, body_b = 0, tet_b = 0;

    auto operator<=>(const Pair&) const = default;
};

/// A contact between a pair: point and normal (out of body a) in world coordinates, depth < 0 inside.
struct ContactPoint {
    Pair pair;
    std::uint32_t feature = 0; ///< number defined by algorithms/narrow_phase
    std::array<double, 3> point{}, normal{};
    double depth = 0;
};

} // namespace tandem
