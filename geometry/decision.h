// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

namespace tandem {

/// Corners of a tetrahedron in either orientation. Any double is allowed, and so is any float.
using TetraCorners = std::array<std::array<double, 3>, 4>;

/// The exact relation of two closed tetrahedra. A tetrahedron without volume is the convex hull of its
/// corners. It has no interior, so it can touch but not overlap.
enum class Relation : std::uint8_t {
    disjoint,    ///< no common point
    touching,    ///< common points, none of them in both interiors
    overlapping, ///< a common point of both interiors
    invalid      ///< a coordinate is not finite
};

/// The test that decided, cheapest first. Each tier passes on the pairs that it cannot decide.
enum class Tier : std::uint8_t {
    screen,       ///< comparisons only: coordinates not finite, or bounding boxes apart
    filter,       ///< double arithmetic with certified error bounds
    integers,     ///< 128-bit integers
    big_integers, ///< GMP integers
    program       ///< a linear program over GMP rationals, for tetrahedra without volume
};
constexpr unsigned tier_count = 5;
constexpr std::array tier_names{"screen", "filter", "integers", "big_integers", "program"};
static_assert(tier_names.size() == tier_count);

/// The relation of a pair, and the tier that decided it.
struct Decision {
    Relation relation = Relation::invalid;
    Tier tier = Tier::screen;

    bool operator==(const Decision&) const = default;
};

/// Whether every coordinate is finite.
bool all_finite(const TetraCorners& corners);

/// Decides the relation of a pair. Tiers before `first` are skipped, so that tests can force the slower ones.
/// The relation depends neither on `first` nor on the order of the corners or of the tetrahedra. Never
/// throws.
Decision decide(const TetraCorners& a, const TetraCorners& b, Tier first = Tier::screen);

inline Relation relation(const TetraCorners& a, const TetraCorners& b) { return decide(a, b).relation; }

/// Counts of decisions by relation and by tier, indexed by the enumerators.
struct DecisionCounts {
    std::array<std::uint64_t, 4> relations{};
    std::array<std::uint64_t, tier_count> tiers{};

    void add(Decision decision);
    void add(const DecisionCounts& other);
    std::uint64_t operator[](Relation r) const { return relations[static_cast<unsigned>(r)]; }
    std::uint64_t operator[](Tier t) const { return tiers[static_cast<unsigned>(t)]; }
};

} // namespace tandem
