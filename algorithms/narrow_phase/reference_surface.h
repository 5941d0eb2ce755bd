// SPDX-License-Identifier: MIT
// The surface of the common part of a pair, for the serial reference of rule clip.
#pragma once

#include "algorithms/narrow_phase/reference_number.h"
#include "algorithms/narrow_phase/reference_pair.h"

namespace tandem::narrow_phase {

/// A point of a face: its first corner + s (second - first) + t (third - first).
template<class Real>
struct FacePoint {
    Number<Real> s, t;
};

template<class Real>
struct FacePart {
    std::vector<FacePoint<Real>> corners;
    Real shift = 0; ///< of its sides, all together
    Real error = 0; ///< of twice its area, where the face has 1/2
};

/// A linear function over a face.
template<class Real>
struct Heights {
    std::array<Number<Real>, 3> at;
    Number<Real> along_s, along_t;
    Real error = 0;
};

template<class Real>
struct CommonSurface {
    NumberVector<Real> sum{};
    Real total = 0, error = 0;
};

/// Euclidean norm; 0 for the vector 0.
template<class Real>
Real length(const Vector<Real>& a) {
    const Real most = largest(a);
    if (most == 0) return 0;
    const auto shorter = a / most;
    return most * std::sqrt(dot(shorter, shorter));
}

/// The surface of the common part of a pair.
template<class Real>
class Clipping {
public:
    Clipping(const ReferencePair<Real>& pair, bool precise) : pair_(pair), arithmetic_(precise) {
        for (unsigned solid = 0; solid < 2; ++solid)
            for (unsigned plane = 0; plane < 4; ++plane) find_sides(solid, plane);
    }

    /// Twice the areas of A's faces inside B minus twice those of B's inside A, and twice the whole area.
    CommonSurface<Real> surface() const {
        CommonSurface<Real> result;
        for (unsigned solid = 0; solid < 2; ++solid)
            for (unsigned face = 0; face < 4; ++face) add(result, solid, face);
        result.error += 16 * arithmetic_.roundoff() * result.total;
        return result;
    }

    /// Extent of the common part along a unit vector.
    Real extent(const Vector<Real>& along) const {
        const NumberVector<Real> axis{{{along[0]}, {along[1]}, {along[2]}}};
        std::vector<Number<Real>> heights;
        for (unsigned solid = 0; solid < 2; ++solid)
            for (unsigned face = 0; face < 4; ++face) {
                const auto over_face = heights_along(axis, {}, pair_.origin, solid, face);
                for (const auto& corner : part(solid, face).corners) heights.push_back(at(over_face, corner));
            }
        if (heights.empty()) return 0;
        auto low = heights[0], high = heights[0];
        for (const auto& height : heights) {
            if (arithmetic_.difference(height, low).value < 0) low = height;
            if (arithmetic_.difference(height, high).value > 0) high = height;
        }
        return arithmetic_.difference(high, low).value;
    }

private:
    using Side = std::array<std::array<bool, 4>, 4>; ///< by corner and face of the other tetrahedron
    struct Sides {
        Side front{}, behind{};
    };

    const Vector<Real>& corner(unsigned solid, unsigned face, unsigned index) const {
        return pair_.world[solid][face_corners[face][index]];
    }

    Vector<Real> edge(unsigned solid, unsigned from, unsigned to) const {
        return (pair_.world[solid][to] - pair_.world[solid][from]) * pair_.scale;
    }

    /// Whether normals of even faces point out of the tetrahedron.
    bool even_outward(unsigned solid) const {
        return dot(edge(solid, 0, 3), cross(edge(solid, 0, 1), edge(solid, 0, 2))) > 0;
    }

    /// A face's outward normal, twice as long as its area, and the magnitudes of its terms.
    std::pair<NumberVector<Real>, Vector<Real>> normal(unsigned solid, unsigned face) const {
        const auto first = arithmetic_.between(corner(solid, face, 0), corner(solid, face, 1), pair_.scale);
        const auto second = arithmetic_.between(corner(solid, face, 0), corner(solid, face, 2), pair_.scale);
        auto result = arithmetic_.cross(first, second);
        if ((face % 2 == 0) != even_outward(solid))
            for (auto& component : result) component = -component;
        const auto a = values(first), b = values(second);
        Vector<Real> terms;
        for (unsigned i = 0; i < 3; ++i) {
            const unsigned j = (i + 1) % 3, k = (i + 2) % 3;
            terms[i] = std::abs(a[j] * b[k]) + std::abs(a[k] * b[j]);
        }
        return {result, terms};
    }

    /// The error of heights up to `highest`, as far from the base as `farthest`.
    Real height_error(const Vector<Real>& terms, const Vector<Real>& farthest, Real highest) const {
        const Real underflow = std::ldexp(Real(1), std::numeric_limits<Real>::digits == 24 ? -120 : -1000);
        return arithmetic_.roundoff() * (9 * dot(terms, farthest) + 13 * highest) + underflow;
    }

    /// Finds which corners are certainly in front of a face of the other tetrahedron, and which behind it.
    void find_sides(unsigned solid, unsigned plane) {
        const auto [axis, terms] = normal(1 - solid, plane);
        for (unsigned i = 0; i < 4; ++i) {
            const auto from_base =
                arithmetic_.between(corner(1 - solid, plane, 0), pair_.world[solid][i], pair_.scale);
            Vector<Real> distance = values(from_base);
            for (Real& x : distance) x = std::abs(x);
            const Real height = arithmetic_.dot(axis, from_base).value;
            const Real error = height_error(terms, distance, std::abs(height));
            sides_[solid].front[i][plane] = height > error;
            sides_[solid].behind[i][plane] = height < -error;
        }
    }

    /// Whether all corners of a face are on one side of a plane.
    static bool has_all(const Side& side, unsigned face, unsigned plane) {
        return std::ranges::all_of(face_corners[face], [&](unsigned i) { return side[i][plane]; });
    }

    /// Heights of a face above `base`, along an axis with terms of these magnitudes.
    Heights<Real> heights_along(const NumberVector<Real>& axis, const Vector<Real>& terms,
                                const Vector<Real>& base, unsigned solid, unsigned face) const {
        Heights<Real> result;
        Vector<Real> farthest{};
        for (unsigned i = 0; i < 3; ++i) {
            const auto from_base = arithmetic_.between(base, corner(solid, face, i), pair_.scale);
            result.at[i] = arithmetic_.dot(axis, from_base);
            for (unsigned k = 0; k < 3; ++k)
                farthest[k] = std::max(farthest[k], std::abs(from_base[k].value));
        }
        result.along_s = arithmetic_.difference(result.at[1], result.at[0]);
        result.along_t = arithmetic_.difference(result.at[2], result.at[0]);
        result.error = height_error(terms, farthest,
                                    std::max({std::abs(result.at[0].value), std::abs(result.at[1].value),
                                              std::abs(result.at[2].value)}));
        return result;
    }

    Number<Real> at(const Heights<Real>& heights, const FacePoint<Real>& point) const {
        const auto along_s = arithmetic_.product(point.s, heights.along_s);
        const auto along_t = arithmetic_.product(point.t, heights.along_t);
        return arithmetic_.sum(arithmetic_.sum(heights.at[0], along_s), along_t);
    }

    /// The point at which the height between two points is 0.
    FacePoint<Real> between(const FacePoint<Real>& p, const FacePoint<Real>& q, const Number<Real>& from,
                            const Number<Real>& to) const {
        const auto fraction = arithmetic_.quotient(from, arithmetic_.difference(from, to));
        const auto moved = [&](const Number<Real>& x, const Number<Real>& y) {
            return arithmetic_.sum(x, arithmetic_.product(fraction, arithmetic_.difference(y, x)));
        };
        return {moved(p.s, q.s), moved(p.t, q.t)};
    }

    static Real width(const std::vector<FacePoint<Real>>& corners) {
        const auto [s_low, s_high] = std::minmax_element(
            corners.begin(), corners.end(), [](auto& p, auto& q) { return p.s.value < q.s.value; });
        const auto [t_low, t_high] = std::minmax_element(
            corners.begin(), corners.end(), [](auto& p, auto& q) { return p.t.value < q.t.value; });
        return std::max(s_high->s.value - s_low->s.value, t_high->t.value - t_low->t.value);
    }

    void cut(FacePart<Real>& part, const Heights<Real>& heights) const {
        std::vector<FacePoint<Real>> kept;
        const Real wide = width(part.corners);
        auto p = part.corners.back();
        auto from = at(heights, p);
        Real most = from.value;
        for (const auto& q : part.corners) {
            const auto to = at(heights, q);
            most = std::max(most, to.value);
            if ((from.value <= 0) != (to.value <= 0)) kept.push_back(between(p, q, from, to));
            if (to.value <= 0) kept.push_back(q);
            p = q;
            from = to;
        }
        part.corners = kept;
        if (most < -heights.error) return;
        const Real slope = std::max(std::abs(heights.along_s.value), std::abs(heights.along_t.value));
        const Real shift = (heights.error < slope ? heights.error / slope : 1) + 32 * arithmetic_.roundoff();
        part.shift += shift;
        part.error += 2 * wide * shift;
    }

    /// The part of a face inside the other tetrahedron.
    FacePart<Real> part(unsigned solid, unsigned face) const {
        const Number<Real> none{}, all{1};
        FacePart<Real> result{{{none, none}, {all, none}, {none, all}}, 0, 0};
        for (unsigned plane = 0; plane < 4; ++plane)
            if (has_all(sides_[solid].front, face, plane)) return {};
        for (unsigned plane = 0; plane < 4; ++plane) {
            if (result.corners.empty() || has_all(sides_[solid].behind, face, plane)) continue;
            const auto [axis, terms] = normal(1 - solid, plane);
            cut(result, heights_along(axis, terms, corner(1 - solid, plane, 0), solid, face));
        }
        return result;
    }

    /// Twice the area of a part, in units of twice the face.
    Number<Real> area(const FacePart<Real>& part) const {
        Number<Real> sum{};
        for (std::size_t i = 2; i < part.corners.size(); ++i) {
            const auto& [base_s, base_t] = part.corners[0];
            const auto s = arithmetic_.difference(part.corners[i - 1].s, base_s);
            const auto t = arithmetic_.difference(part.corners[i - 1].t, base_t);
            const auto next_s = arithmetic_.difference(part.corners[i].s, base_s);
            const auto next_t = arithmetic_.difference(part.corners[i].t, base_t);
            sum = arithmetic_.sum(
                sum, arithmetic_.difference(arithmetic_.product(s, next_t), arithmetic_.product(next_s, t)));
        }
        return sum;
    }

    /// The error of twice a part's area.
    static Real error(const FacePart<Real>& part, Real fraction) {
        const Real around = part.corners.empty() ? 0 : 4 * width(part.corners) * part.shift;
        return 4 * around < fraction ? std::min(around, part.error) : part.error;
    }

    void add(CommonSurface<Real>& surface, unsigned solid, unsigned face) const {
        const auto inside = part(solid, face);
        if (inside.corners.empty() && inside.error == 0) return;
        const auto fraction = area(inside);
        const auto [axis, terms] = normal(solid, face);
        for (unsigned k = 0; k < 3; ++k) {
            const auto addend = arithmetic_.product(fraction, axis[k]);
            surface.sum[k] = arithmetic_.sum(surface.sum[k], solid == 0 ? addend : -addend);
        }
        const Real whole = length(values(axis));
        surface.total += whole * fraction.value;
        surface.error += whole * error(inside, fraction.value);
        surface.error += 8 * arithmetic_.roundoff() * fraction.value * largest(terms);
    }

    const ReferencePair<Real>& pair_;
    Arithmetic<Real> arithmetic_;
    std::array<Sides, 2> sides_;
};

} // namespace tandem::narrow_phase
