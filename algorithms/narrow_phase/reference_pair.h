// SPDX-License-Identifier: MIT
// One pair in the serial reference: loading, separation, and the features of the common part.
#pragma once

#include "algorithms/narrow_phase/reference_geometry.h"

namespace tandem::narrow_phase {

/// A point that two tetrahedra have in common, at one feature.
template<class Real>
struct SharedPoint {
    unsigned feature = 0;
    Vector<Real> point{}; ///< local
};

template<class Real>
struct ReferencePair {
    static inline const Real shortest = std::ldexp(Real(1), -96); ///< shortest axis that is tested

    std::array<Tetrahedron<Real>, 2> solids;
    std::array<Corners<Real>, 2> world;
    std::array<std::array<Real, 4>, 2> pressures{}; ///< at the corners
    std::array<Corners<Real>, 2> axes;              ///< the normals before they are made unit vectors
    Vector<Real> origin{};
    Real size = 0;
    Real scale = 1;
    bool apart = false;   ///< found not to meet
    bool swapped = false; ///< the first tetrahedron is the given B
    float margin = 0;     ///< of a rule that wants near pairs

    /// Returns false if a coordinate is unusable or, unless the pair is known to be apart, a volume
    /// uncertain.
    bool load(const Corners<Real>& a, const Corners<Real>& b) {
        const Real longest_allowed = std::ldexp(Real(1), std::numeric_limits<Real>::max_exponent - 5);
        world = {a, b};
        origin = a[0];
        for (unsigned i = 0; i < 4; ++i) {
            solids[0].corners[i] = a[i] - origin;
            solids[1].corners[i] = b[i] - origin;
        }
        for (const auto& solid : solids)
            for (const auto& corner : solid.corners)
                for (const Real value : corner) {
                    if (!std::isfinite(value) || std::abs(value) > longest_allowed) return false;
                    size = std::max(size, std::abs(value));
                }
        scale = scale_of(size);
        size *= scale;
        for (auto& solid : solids)
            for (auto& corner : solid.corners) corner = corner * scale;
        const auto normals_a = outward_normals(a);
        const auto normals_b = outward_normals(b);
        if (!normals_a || !normals_b) return apart;
        axes = {*normals_a, *normals_b};
        for (unsigned i = 0; i < 8; ++i) solids[i / 4].normals[i % 4] = unit(axes[i / 4][i % 4]);
        return true;
    }

    Real tolerance() const { return 32 * unit_roundoff<Real> * size; }

    /// Lowest and highest projections of A, then of B.
    std::array<Real, 4> extents(const Vector<Real>& axis) const {
        std::array<Real, 4> result;
        for (unsigned s = 0; s < 2; ++s) {
            const auto& c = solids[s].corners;
            const auto [low, high] =
                std::minmax({dot(axis, c[0]), dot(axis, c[1]), dot(axis, c[2]), dot(axis, c[3])});
            result[2 * s] = low;
            result[2 * s + 1] = high;
        }
        return result;
    }

    bool separated() const {
        static const Real lengthen = std::ldexp(Real(1), std::numeric_limits<Real>::digits == 24 ? 64 : 978);
        for (const auto& some : axes)
            for (const auto& axis : some)
                if (separated_along(largest(axis) < shortest ? axis * lengthen : axis)) return true;
        for (const auto& [i, j] : edge_ends)
            for (const auto& [k, l] : edge_ends) {
                const auto& a = solids[0].corners;
                const auto& b = solids[1].corners;
                if (separated_along(cross(a[j] - a[i], b[l] - b[k]))) return true;
            }
        return false;
    }

    /// Corners inside the other tetrahedron and edges through its faces, in ascending order of feature.
    std::vector<SharedPoint<Real>> shared_points() const {
        std::vector<SharedPoint<Real>> result;
        for (unsigned owner = 0; owner < 2; ++owner)
            for (unsigned corner = 0; corner < 4; ++corner)
                if (inside(solids[1 - owner], solids[owner].corners[corner], 4, tolerance()))
                    result.push_back({4 * owner + corner, solids[owner].corners[corner]});
        for (unsigned owner = 0; owner < 2; ++owner)
            for (unsigned edge = 0; edge < 6; ++edge)
                for (unsigned face = 0; face < 4; ++face) {
                    const auto [ahead, behind] = ends(owner, edge, face);
                    if (std::min(std::abs(ahead), std::abs(behind)) <= tolerance()) continue;
                    if ((ahead > 0) == (behind > 0)) continue;
                    const auto p = crossing(owner, edge, face);
                    if (inside(solids[1 - owner], p, face, tolerance()))
                        result.push_back({8 + 24 * owner + 4 * edge + face, p});
                }
        return result;
    }

    /// Whether p is at most `near` in front of all faces of the solid except `skipped`.
    bool inside(const Tetrahedron<Real>& solid, const Vector<Real>& p, unsigned skipped, Real near) const {
        for (unsigned face = 0; face < 4; ++face)
            if (face != skipped && solid.distance(face, p) > near) return false;
        return true;
    }

    /// Distances of an edge's ends from a face of the other tetrahedron.
    std::pair<Real, Real> ends(unsigned owner, unsigned edge, unsigned face) const {
        const auto& corners = solids[owner].corners;
        const auto& other = solids[1 - owner];
        return {other.distance(face, corners[edge_ends[edge][0]]),
                other.distance(face, corners[edge_ends[edge][1]])};
    }

    Vector<Real> crossing(unsigned owner, unsigned edge, unsigned face) const {
        const auto& from = solids[owner].corners[edge_ends[edge][0]];
        const auto& to = solids[owner].corners[edge_ends[edge][1]];
        const auto [ahead, behind] = ends(owner, edge, face);
        return from + (to - from) * (ahead / (ahead - behind));
    }

    Contact<Real> contact(const SharedPoint<Real>& shared, const Vector<Real>& normal, Real depth) const {
        const Vector<Real> no_negative_zero{};
        return {shared.feature, shared.point / scale + origin + no_negative_zero, normal + no_negative_zero,
                depth / scale + Real(0)};
    }

private:
    bool separated_along(const Vector<Real>& axis) const {
        const Real norm = taxicab(axis);
        if (norm < shortest) return false;
        const auto [low_a, high_a, low_b, high_b] = extents(axis);
        const Real error = 12 * unit_roundoff<Real> * norm * size;
        return low_b - high_a > error || low_a - high_b > error;
    }
};

/// Bits of the boundary faces of A and of B.
using Boundaries = std::array<unsigned, 2>;

// The contacts of a loaded pair by rule WORD, WORD_contacts(), in ascending order of feature. The pair is in
// canonical order where the rule has that trait. Defined in rules/WORD.cpp, which ends with
// TANDEM_REFERENCE_OF.
#define TANDEM_DECLARE_REFERENCE(word, traits, help)                                                         \
    template<class Real>                                                                                     \
    std::vector<Contact<Real>> word##_contacts(const ReferencePair<Real>& pair,                              \
                                               const Boundaries& boundaries);
TANDEM_CONTACT_RULES(TANDEM_DECLARE_REFERENCE)
#undef TANDEM_DECLARE_REFERENCE

#define TANDEM_REFERENCE_OF(word)                                                                            \
    template std::vector<Contact<float>> word##_contacts(const ReferencePair<float>&, const Boundaries&);    \
    template std::vector<Contact<double>> word##_contacts(const ReferencePair<double>&, const Boundaries&);

/// What distances of corners behind faces prove: 1 apart, 2 meeting, 0 neither. Whether they prove anything
/// may depend on the order of corners and tetrahedra; the verdict does not.
template<class Real>
unsigned certificate(const Corners<Real>& a, const Corners<Real>& b);

/// What arithmetic in Real proves: 1 apart, 2 meeting, 0 neither. The order of corners and tetrahedra makes
/// no difference.
template<class Real>
unsigned certain_verdict(const Corners<Real>& a, const Corners<Real>& b);

} // namespace tandem::narrow_phase
