// SPDX-License-Identifier: MIT
#include "geometry/exact_distance.h"

#include "geometry/lattice.h"
#include "geometry/rounding.h"

#include <algorithm>

namespace tandem {

namespace {

using namespace geometry;
using Integers = Vector<mpz_class>;
using Rationals = Vector<mpq_class>;

mpq_class quotient(const mpz_class& a, const mpz_class& b) {
    mpq_class result(a, b);
    result.canonicalize();
    return result;
}

mpq_class within_unit(const mpq_class& x) { return std::min(std::max(x, mpq_class(0)), mpq_class(1)); }

/// The squared distance of the segment from p along e and the one from q along f.
mpq_class between_edges(const Integers& p, const Integers& e, const Integers& q, const Integers& f) {
    const auto r = minus(q, p);
    const mpz_class ee = dot(e, e), ff = dot(f, f), ef = dot(e, f), er = dot(e, r), fr = dot(f, r);
    const mpz_class spread = ee * ff - ef * ef;
    mpq_class s = spread > 0 ? within_unit(quotient(er * ff - fr * ef, spread)) : mpq_class(0);
    const mpq_class foot = ff > 0 ? mpq_class((s * ef - fr) / ff) : mpq_class(0);
    const auto t = within_unit(foot);
    if ((t != foot || spread == 0) && ee > 0) s = within_unit((er + t * ef) / ee);
    Rationals w;
    for (unsigned i = 0; i < 3; ++i) w[i] = r[i] + t * f[i] - s * e[i];
    return dot(w, w);
}

/// The squared distance of a point from the plane of a triangle with an area, if its foot is inside.
std::optional<mpq_class> over_face(const Integers& point, const Integers& first, const Integers& second,
                                   const Integers& third) {
    const auto e = minus(second, first), f = minus(third, first), v = minus(point, first), n = cross(e, f);
    const mpz_class square = dot(n, n), of_second = dot(v, cross(f, n)), of_third = dot(v, cross(n, e));
    if (square == 0 || of_second < 0 || of_third < 0 || of_second + of_third > square) return std::nullopt;
    const mpz_class height = dot(v, n);
    return quotient(height * height, square);
}

} // namespace

std::optional<double> exact_distance(const TetraCorners& a, const TetraCorners& b) {
    if (relation(a, b) != Relation::disjoint) return std::nullopt;
    const auto lattice = big_lattice(a, b);
    std::optional<mpq_class> least;
    const auto consider = [&least](const std::optional<mpq_class>& square) {
        if (square && (!least || *square < *least)) least = square;
    };
    const auto &p = lattice.a, &q = lattice.b;
    for (const auto& e : edges)
        for (const auto& f : edges)
            consider(
                between_edges(p[e.from], minus(p[e.to], p[e.from]), q[f.from], minus(q[f.to], q[f.from])));
    for (const auto& [i, j, k] : faces)
        for (unsigned corner = 0; corner < 4; ++corner) {
            consider(over_face(q[corner], p[i], p[j], p[k]));
            consider(over_face(p[corner], q[i], q[j], q[k]));
        }
    return nearest_root(scaled(*least, 2L * lattice.exponent));
}

} // namespace tandem
