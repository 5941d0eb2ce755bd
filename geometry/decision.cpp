// SPDX-License-Identifier: MIT
#include "geometry/decision.h"

#include "geometry/filter.h"
#include "geometry/lattice.h"
#include "geometry/program.h"

#include <algorithm>
#include <cmath>

namespace tandem {

namespace {

using namespace geometry;

/// Uses comparisons only, which do not round.
bool boxes_apart(const TetraCorners& a, const TetraCorners& b) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        const auto low = [axis](const TetraCorners& c) {
            return std::min(std::min(c[0][axis], c[1][axis]), std::min(c[2][axis], c[3][axis]));
        };
        const auto high = [axis](const TetraCorners& c) {
            return std::max(std::max(c[0][axis], c[1][axis]), std::max(c[2][axis], c[3][axis]));
        };
        if (low(a) > high(b) || low(b) > high(a)) return true;
    }
    return false;
}

/// Decides by the facets that the filter left open. No value when a tetrahedron has no volume.
template<class Number>
std::optional<Relation> decide_by_facets(const Lattice<Number>& lattice, const Filtered& filtered) {
    if (!filtered.volume[0] && orientation(lattice.a) == 0) return std::nullopt;
    if (!filtered.volume[1] && orientation(lattice.b) == 0) return std::nullopt;
    auto relation = Relation::overlapping;
    for_each_facet(lattice.a, lattice.b, filtered.unsure, [&](const Facet<Number>& facet) {
        if (facet.gap == 0) relation = Relation::touching;
        if (facet.gap > 0) relation = Relation::disjoint;
        return relation != Relation::disjoint;
    });
    return relation;
}

/// For tetrahedra without volume, which have no facets. Without an interior they can touch but not overlap.
Decision decide_by_program(const TetraCorners& a, const TetraCorners& b) {
    const auto lattice = big_lattice(a, b);
    return {hulls_meet(lattice.a, lattice.b) ? Relation::touching : Relation::disjoint, Tier::program};
}

/// Decides pairs that the filter left undecided.
Decision decide_by_integers(const TetraCorners& a, const TetraCorners& b, const Filtered& filtered,
                            Tier first) {
    std::optional<Relation> found;
    auto tier = Tier::integers;
    if (const auto lattice = first <= tier ? small_lattice(a, b) : std::nullopt) {
        found = decide_by_facets(*lattice, filtered);
    } else {
        tier = Tier::big_integers;
        found = decide_by_facets(big_lattice(a, b), filtered);
    }
    return found ? Decision{*found, tier} : decide_by_program(a, b);
}

} // namespace

bool all_finite(const TetraCorners& corners) {
    return std::ranges::all_of(corners, [](const auto& corner) {
        return std::isfinite(corner[0]) && std::isfinite(corner[1]) && std::isfinite(corner[2]);
    });
}

Decision decide(const TetraCorners& a, const TetraCorners& b, Tier first) {
    if (!all_finite(a) || !all_finite(b)) return {Relation::invalid, Tier::screen};
    if (first <= Tier::screen && boxes_apart(a, b)) return {Relation::disjoint, Tier::screen};
    Filtered filtered;
    if (first <= Tier::filter) filtered = filter(a, b);
    if (filtered.disjoint) return {Relation::disjoint, Tier::filter};
    if (filtered.unsure == 0 && filtered.volume[0] && filtered.volume[1])
        return {Relation::overlapping, Tier::filter};
    return decide_by_integers(a, b, filtered, first);
}

void DecisionCounts::add(Decision decision) {
    ++relations[static_cast<unsigned>(decision.relation)];
    ++tiers[static_cast<unsigned>(decision.tier)];
}

void DecisionCounts::add(const DecisionCounts& other) {
    for (unsigned i = 0; i < relations.size(); ++i) relations[i] += other.relations[i];
    for (unsigned i = 0; i < tiers.size(); ++i) tiers[i] += other.tiers[i];
}

} // namespace tandem
