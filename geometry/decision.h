// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

namespace tandem {

/// Corners of a tetrahedron in either orientation; any doubles, among them every float.
using TetraCorners = std::array<std::array<double, 3>, 4>;

/// How two closed tetrahedra lie to each other, exactly. A tetrahedron of no volume is the convex hull of its
/// corners; having no interior, it touches whatever it meets.
enum class Relation : std::uint8_t {
    disjoint,    ///< no common point
    touching,    ///< common points, none of them inside both
    overlapping, ///< a point inside both
    invalid      ///< a coordinate is not finite
};

/// What decided, cheapest first. Each tier hands on what it cannot decide.
enum class Tier : std::uint8_t {
    screen,       ///< coordinates that are not finite, boxes apart: comparisons only
    filter,       ///< double with certified bounds
    integers,     ///< integers of 128 bits
    big_integers, ///< GMP integers
    program       ///< a linear program over GMP rationals: tetrahedra of no volume
};
constexpr unsigned tier_count = 5;
constexpr std::array tier_names{"screen", "filter", "integers", "big_integers", "program"};
static_assert(tier_names.size() == tier_count);

/// How a pair lies, and the tier that knew it.
struct Decision {
    Relation relation = Relation::invalid;
    Tier tier = Tier::screen;

    bool operator==(const Decision&) const = default;
};

/// Whether no coordinate is infinite or no number.
bool all_finite(const TetraCorners& corners);

/// Decides from tier `first` on: tests force the slower ones. The answer does not depend on `first`, on the
/// order of the corners, or on which tetrahedron is named first. Never throws.
Decision decide(const TetraCorners& a, const TetraCorners& b, Tier first = Tier::screen);

inline Relation relation(const TetraCorners& a, const TetraCorners& b) { return decide(a, b).relation; }

/// Decisions by relation and by tier, indexed by the enumerators.
struct DecisionCounts {
    std::array<std::uint64_t, 4> relations{};
    std::array<std::uint64_t, tier_count> tiers{};

    void add(Decision decision);
    void add(const DecisionCounts& other);
    std::uint64_t operator[](Relation r) const { return relations[static_cast<unsigned>(r)]; }
    std::uint64_t operator[](Tier s) const { return tiers[static_cast<unsigned>(s)]; }
};

} // namespace tandem
