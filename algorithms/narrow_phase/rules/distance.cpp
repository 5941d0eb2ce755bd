// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_axes.h"
#include "algorithms/narrow_phase/reference_number.h"

namespace tandem::narrow_phase {

namespace {

/// The closest points as seen from A, local.
template<class Real>
struct Closest {
    Number<Real> square{std::numeric_limits<Real>::infinity()}; ///< of the distance
    unsigned corners = 0; ///< that span the features of the two: bits 0..3 of A, 4..7 of B
    Vector<Real> point{}, normal{};
    Real distance = 0;
};

/// All pairs of features, with numbers of one or two words. B is moved by `shift` if numbers have one word.
template<class Real>
class Search {
public:
    Search(const ReferencePair<Real>& pair, const Vector<Real>& shift, bool precise)
        : pair_(pair), shift_(shift), precise_(precise), with_(precise) {}

    Closest<Real> run() {
        for (const auto& e : edge_ends)
            for (const auto& f : edge_ends) consider_edges(e, f);
        for (unsigned owner = 0; owner < 2; ++owner)
            for (unsigned face = 0; face < 4; ++face) consider_face(owner, face);
        return best_;
    }

private:
    using Value = Number<Real>;
    using Values = NumberVector<Real>;

    static Real least_span() {
        return std::ldexp(Real(1), std::numeric_limits<Real>::digits == 24 ? -100 : -256);
    }
    static Real inverse(Real square) { return square >= least_span() ? 1 / square : 0; }
    static bool is_inner(const Value& s) {
        return 0 < s.value && (s.value < 1 || (s.value == 1 && s.rest < 0));
    }
    static Value clamped(const Value& s) { return is_inner(s) ? s : Value{s.value > 0 ? Real(1) : Real(0)}; }
    Value share(const Value& a, const Value& square) const {
        if (!precise_) return {a.value * inverse(square.value)};
        return square.value >= least_span() ? with_.quotient(a, square) : Value{};
    }

    Values between(unsigned solid, unsigned from, unsigned to) const {
        return with_.between(pair_.world[solid][from], pair_.world[solid][to], pair_.scale);
    }
    /// From a corner of one solid to one of the other.
    Values across(unsigned solid, unsigned from, unsigned to) const {
        auto r = with_.between(pair_.world[solid][from], pair_.world[1 - solid][to], pair_.scale);
        if (precise_) return r;
        for (unsigned i = 0; i < 3; ++i) r[i].value += solid == 0 ? shift_[i] : -shift_[i];
        return r;
    }
    Value sum(const Value& a, const Value& factor, const Value& b) const {
        return with_.sum(a, with_.product(factor, b));
    }
    Values moved(Values a, const Value& factor, const Values& b) const {
        for (unsigned i = 0; i < 3; ++i) a[i] = sum(a[i], factor, b[i]);
        return a;
    }
    Value minor(const Value& a, const Value& b, const Value& c, const Value& d) const {
        return with_.difference(with_.product(a, d), with_.product(b, c));
    }

    /// `w` without its part along the axis.
    Vector<Real> rejected(const Values& w, const Values& axis) const {
        return values(moved(w, -share(with_.dot(w, axis), with_.dot(axis, axis)), axis));
    }

    bool is_closer(const Value& square) const {
        return std::pair(square.value, square.rest) < std::pair(best_.square.value, best_.square.rest);
    }
    bool is_certain(Real spread, Real squares) const {
        return spread > (precise_ ? 64 * unit_roundoff<Real> : Real(16)) * unit_roundoff<Real> * squares;
    }

    static unsigned ends(const unsigned (&edge)[2], const Value& s) {
        if (is_inner(s)) return 1u << edge[0] | 1u << edge[1];
        return 1u << edge[s.value > 0 ? 1 : 0];
    }

    void consider_edges(const unsigned (&of_a)[2], const unsigned (&of_b)[2]) {
        const auto e = between(0, of_a[0], of_a[1]), f = between(1, of_b[0], of_b[1]),
                   r = across(0, of_a[0], of_b[0]);
        const auto ee = with_.dot(e, e), ff = with_.dot(f, f), ef = with_.dot(e, f), er = with_.dot(e, r),
                   fr = with_.dot(f, r);
        const auto spread = minor(ee, ef, ef, ff);
        const bool is_spread = is_certain(spread.value, ee.value * ff.value);
        auto s = is_spread ? clamped(with_.quotient(minor(er, ef, fr, ff), spread)) : Value{Real(0.5)};
        const auto foot = share(sum(-fr, s, ef), ff), t = clamped(foot);
        if (!is_spread || t.value != foot.value || t.rest != foot.rest)
            s = clamped(share(sum(er, t, ef), ee));
        const auto w = moved(moved(r, t, f), -s, e);
        const auto square = with_.dot(w, w);
        if (!is_closer(square)) return;
        const bool inside_e = is_inner(s), inside_f = is_inner(t);
        auto normal = values(w);
        const auto product = with_.cross(e, f);
        const bool has_product = is_certain(with_.dot(product, product).value, ee.value * ff.value);
        if (inside_e && inside_f && has_product) {
            normal = values(product);
            if (dot(normal, values(w)) < 0) normal = normal * Real(-1);
        } else if (inside_e) {
            normal = rejected(w, e);
        } else if (inside_f) {
            normal = rejected(w, f);
        }
        best_ = {square, ends(of_a, s) | ends(of_b, t) << 4,
                 pair_.solids[0].corners[of_a[0]] + values(e) * s.value, normal, std::sqrt(square.value)};
    }

    void consider_face(unsigned owner, unsigned face) {
        const auto& [first, second, third] = face_corners[face];
        const auto to_second = between(owner, first, second), to_third = between(owner, first, third);
        const auto n = with_.cross(to_second, to_third);
        const auto of_second = with_.cross(to_third, n), of_third = with_.cross(n, to_second);
        const auto length = with_.dot(n, n);
        for (unsigned corner = 0; corner < 4; ++corner) {
            const auto v = across(owner, first, corner);
            const auto p = with_.dot(v, of_second), q = with_.dot(v, of_third);
            if (!(p.value >= 0 && q.value >= 0 && with_.sum(p, q).value <= length.value
                  && length.value >= least_span()))
                continue;
            const auto height = with_.dot(v, n), square = with_.product(height, share(height, length));
            if (!is_closer(square)) continue;
            // From the foot on the face to the corner, then from A to B.
            auto w = moved(moved(v, -share(p, length), to_second), -share(q, length), to_third);
            if (owner == 1)
                for (auto& x : w) x = -x;
            const auto step = values(w);
            const auto normal = values(n) * Real(dot(values(n), step) < 0 ? -1 : 1);
            const unsigned own = 15u & ~(1u << face), other = 1u << corner;
            const auto point = owner == 0 ? (pair_.solids[1].corners[corner] + shift_) - step
                                          : pair_.solids[0].corners[corner];
            best_ = {square, owner == 0 ? own | other << 4 : other | own << 4, point, normal,
                     std::sqrt(with_.dot(w, w).value)};
        }
    }

    const ReferencePair<Real>& pair_;
    Vector<Real> shift_;
    bool precise_;
    Arithmetic<Real> with_;
    Closest<Real> best_;
};

template<class Real>
Closest<Real> closest_points(const ReferencePair<Real>& pair, const Vector<Real>& shift, bool precise) {
    auto closest = Search<Real>(pair, shift, precise).run();
    closest.normal = largest(closest.normal) > 0 ? unit(closest.normal) : Vector<Real>{1, 0, 0};
    return closest;
}

} // namespace

template<class Real>
std::vector<Contact<Real>> distance_contacts(const ReferencePair<Real>& pair, const Boundaries&) {
    Closest<Real> closest;
    Real distance;
    if (pair.apart) {
        closest = closest_points(pair, {}, false);
        const auto [low_a, high_a, low_b, high_b] = pair.extents(closest.normal);
        const Real certain = 4 * unit_roundoff<Real> * pair.size;
        if (!(low_b - high_a >= closest.distance - certain)) closest = closest_points(pair, {}, true);
        distance = closest.distance;
    } else {
        const auto [normal, overlap] = least_translation(pair, all_faces);
        closest = closest_points(pair, normal * overlap, false);
        closest.normal = normal;
        distance = -overlap;
    }
    if (!(distance <= Real(pair.margin) * pair.scale + pair.tolerance())) return {};
    if (pair.swapped) closest.point = closest.point + closest.normal * distance;
    return {pair.contact({closest.corners, closest.point}, closest.normal, distance)};
}

TANDEM_REFERENCE_OF(distance)

} // namespace tandem::narrow_phase
