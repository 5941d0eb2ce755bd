// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference.h"

#include "geometry/meet_exactly.h"
#include "algorithms/narrow_phase/reference_pair.h"
#include "algorithms/narrow_phase/reference_polygon.h"

namespace tandem {

namespace {

using namespace narrow_phase;

/// A tetrahedron's corners in ascending order, and their given numbers.
template<class Real>
struct Sorted {
    Corners<Real> corners;
    std::array<unsigned, 4> names{0, 1, 2, 3};

    explicit Sorted(const Corners<Real>& given) {
        // A network, which gives the names of equal corners their order, too.
        constexpr unsigned network[][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}};
        for (const auto& [i, j] : network)
            if (given[names[j]] < given[names[i]]) std::swap(names[i], names[j]);
        for (unsigned i = 0; i < 4; ++i) corners[i] = given[names[i]];
    }
};

/// The number of a feature of the sorted pair in the given one. `own` has the feature; `other` is the other
/// tetrahedron.
template<class Real>
unsigned given_feature(unsigned feature, const Sorted<Real>& own, const Sorted<Real>& other,
                       unsigned given_owner) {
    if (feature < 8) return 4 * given_owner + own.names[feature % 4];
    const unsigned edge = (feature - 8) % 24 / 4;
    const auto [low, high] = std::minmax(own.names[edge_ends[edge][0]], own.names[edge_ends[edge][1]]);
    unsigned number = 0;
    while (edge_ends[number][0] != low || edge_ends[number][1] != high) ++number;
    return 8 + 24 * given_owner + 4 * number + other.names[feature % 4];
}

/// Boundary bits of the given faces, in the order of the sorted corners opposite to them.
template<class Real>
unsigned sorted_faces(unsigned given, const Sorted<Real>& sorted) {
    unsigned faces = 0;
    for (unsigned i = 0; i < 4; ++i)
        if ((given & 1u << sorted.names[i]) != 0) faces |= 1u << i;
    return faces;
}

/// Requires canonical order where the rule has that trait.
template<class Real>
std::vector<Contact<Real>> contacts_by_rule(const ReferencePair<Real>& pair, ContactRule rule,
                                            const Boundaries& boundaries) {
    switch (rule) {
#define TANDEM_CASE(word, traits, help)                                                                      \
    case ContactRule::word:                                                                                  \
        return word##_contacts(pair, boundaries);
        TANDEM_CONTACT_RULES(TANDEM_CASE)
#undef TANDEM_CASE
    case ContactRule::none:
        break;
    }
    return {};
}

template<class Real>
Corners<double> widened(const Corners<Real>& corners) {
    Corners<double> result;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned k = 0; k < 3; ++k) result[i][k] = static_cast<double>(corners[i][k]);
    return result;
}

/// Whether the decision finds the pair apart before contacts are made.
template<class Real>
bool decided_apart(const Corners<Real>& a, const Corners<Real>& b, DecisionPrecision decision,
                   ContactCounts& counts) {
    if (!has_verdicts(decision)) return false;
    unsigned verdict = 0;
    if (decision != DecisionPrecision::fp64) verdict = certificate(a, b);
    if (verdict == 0 && decision != DecisionPrecision::fp64) verdict = certain_verdict(a, b);
    if (verdict == 0 && decision != DecisionPrecision::fp64) ++counts.undecided_by_filter;
    if (verdict == 0) {
        verdict = certain_verdict(widened(a), widened(b));
        counts.undecided_by_double += verdict == 0 ? 1 : 0;
    }
    if (verdict == 0 && decision == DecisionPrecision::exact)
        verdict = meet_exactly(widened(a), widened(b)) ? 2 : 1;
    return verdict == 1;
}

template<class Real>
bool finite(const Corners<Real>& corners) {
    return std::all_of(corners.begin(), corners.end(), [](const auto& corner) {
        return std::all_of(corner.begin(), corner.end(), [](Real x) { return std::isfinite(x); });
    });
}

/// Loads the pair and tests separation unless it is decided. Returns false, and counts why, if it makes no
/// contacts; a pair apart makes a row if the rule wants near pairs.
template<class Real>
bool loads(ReferencePair<Real>& pair, const Corners<Real>& a, const Corners<Real>& b,
           const ContactSettings& settings, ContactCounts& counts) {
    if (!pair.load(a, b)) {
        if (!pair.apart) ++counts.degenerate;
        return false;
    }
    if (pair.apart || settings.decision != DecisionPrecision::fp32 || !pair.separated()) return true;
    ++counts.rejected;
    pair.apart = true;
    return has_near_pairs(settings.rule);
}

/// Bits of corners of the sorted pair in the given one.
template<class Real>
unsigned given_corners(unsigned bits, const Sorted<Real>& first, const Sorted<Real>& second, bool swapped) {
    unsigned of_first = 0, of_second = 0;
    for (unsigned i = 0; i < 4; ++i) {
        of_first |= (bits >> i & 1u) << first.names[i];
        of_second |= (bits >> (4 + i) & 1u) << second.names[i];
    }
    return swapped ? of_second | of_first << 4 : of_first | of_second << 4;
}

/// Values at the given corners, in the order of the sorted ones.
template<class Real>
std::array<Real, 4> sorted_values(const std::array<Real, 4>& given, const Sorted<Real>& sorted) {
    std::array<Real, 4> values;
    for (unsigned i = 0; i < 4; ++i) values[i] = given[sorted.names[i]];
    return values;
}

/// A pair in canonical order.
template<class Real>
struct CanonicalPair {
    Sorted<Real> first, second;
    Boundaries boundaries;

    /// `pair`: not loaded; gets all but the corners.
    CanonicalPair(ReferencePair<Real>& pair, const GivenTetrahedron<Real>& a, const GivenTetrahedron<Real>& b)
        : first(a.corners),
          second(b.corners),
          boundaries{sorted_faces(a.boundary, first), sorted_faces(b.boundary, second)} {
        pair.pressures = {sorted_values(a.pressures, first), sorted_values(b.pressures, second)};
        pair.swapped = second.corners < first.corners;
        if (!pair.swapped) return;
        std::swap(first, second);
        std::swap(boundaries[0], boundaries[1]);
        std::swap(pair.pressures[0], pair.pressures[1]);
    }
};

/// The number of a contact's feature in the given pair.
template<class Real>
unsigned given_number(unsigned feature, const CanonicalPair<Real>& sorted, bool swapped, ContactRule rule) {
    if (needs_pressures(rule)) return feature; // the number of corners
    if (has_near_pairs(rule)) return given_corners(feature, sorted.first, sorted.second, swapped);
    const unsigned owner = feature < 8 ? feature / 4 : feature < 32 ? 0 : 1;
    const unsigned given_owner = swapped ? 1 - owner : owner;
    return owner == 0 ? given_feature(feature, sorted.first, sorted.second, given_owner)
                      : given_feature(feature, sorted.second, sorted.first, given_owner);
}

/// `pair`: not loaded.
template<class Real>
std::vector<Contact<Real>> canonical_contacts(ReferencePair<Real>& pair, const GivenTetrahedron<Real>& a,
                                              const GivenTetrahedron<Real>& b,
                                              const ContactSettings& settings, ContactCounts& counts) {
    if (!finite(a.corners) || !finite(b.corners)) {
        if (!pair.apart) ++counts.degenerate;
        return {};
    }
    const CanonicalPair<Real> sorted(pair, a, b);
    if (!loads(pair, sorted.first.corners, sorted.second.corners, settings, counts)) return {};
    auto contacts = contacts_by_rule(pair, settings.rule, sorted.boundaries);
    if (needs_pressures(settings.rule) && contacts.empty()) ++counts.rejected;
    for (auto& contact : contacts) {
        contact.feature = given_number(contact.feature, sorted, pair.swapped, settings.rule);
        if (pair.swapped)
            for (Real& x : contact.normal) x = -x + Real(0);
    }
    std::sort(contacts.begin(), contacts.end(),
              [](const auto& p, const auto& q) { return p.feature < q.feature; });
    return contacts;
}

/// Whether some number is between the least and the greatest of both.
template<class Real>
bool have_common(const std::array<Real, 4>& p, const std::array<Real, 4>& q) {
    return std::ranges::max(p) >= std::ranges::min(q) && std::ranges::max(q) >= std::ranges::min(p);
}

} // namespace

template<class Real>
std::vector<Contact<Real>> reference_contacts(const GivenTetrahedron<Real>& a,
                                              const GivenTetrahedron<Real>& b, ContactCounts& counts,
                                              const ContactSettings& settings) {
    const unsigned with_faces = (a.boundary != 0 ? 1 : 0) + (b.boundary != 0 ? 1 : 0);
    if (with_faces < boundaries_needed(settings.rule)) {
        ++counts.without_boundary;
        return {};
    }
    if (needs_pressures(settings.rule) && !have_common(a.pressures, b.pressures)) {
        ++counts.rejected;
        return {};
    }
    ReferencePair<Real> pair;
    pair.margin = margin_of(settings);
    pair.apart = decided_apart(a.corners, b.corners, settings.decision, counts);
    if (pair.apart) {
        ++counts.rejected;
        if (!has_near_pairs(settings.rule)) return {};
    }
    if ((traits_of(settings.rule) & TANDEM_CANONICAL) != 0)
        return canonical_contacts(pair, a, b, settings, counts);
    if (!loads(pair, a.corners, b.corners, settings, counts)) return {};
    return contacts_by_rule(pair, settings.rule, {a.boundary, b.boundary});
}

template<class Real>
PolygonCorners<Real> polygon_of_equal_pressure(const GivenTetrahedron<Real>& a,
                                               const GivenTetrahedron<Real>& b) {
    if (!finite(a.corners) || !finite(b.corners) || !have_common(a.pressures, b.pressures)) return {};
    ReferencePair<Real> pair;
    const CanonicalPair<Real> sorted(pair, a, b);
    if (!pair.load(sorted.first.corners, sorted.second.corners)) return {};
    const auto polygon = pressure_polygon(pair);
    PolygonCorners<Real> result{{}, polygon.pressures};
    for (const auto& corner : polygon.corners) result.points.push_back(corner / pair.scale + pair.origin);
    return result;
}

#define TANDEM_REFERENCE_IN(Real)                                                                            \
    template std::vector<Contact<Real>> reference_contacts(const GivenTetrahedron<Real>&,                    \
                                                           const GivenTetrahedron<Real>&, ContactCounts&,    \
                                                           const ContactSettings&);                          \
    template PolygonCorners<Real> polygon_of_equal_pressure(const GivenTetrahedron<Real>&,                   \
                                                            const GivenTetrahedron<Real>&);
TANDEM_REFERENCE_IN(float)
TANDEM_REFERENCE_IN(double)
#undef TANDEM_REFERENCE_IN

} // namespace tandem
