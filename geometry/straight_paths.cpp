// SPDX-License-Identifier: MIT
#include "geometry/straight_paths.h"

#include "geometry/facets.h"
#include "geometry/lattice.h"
#include "geometry/polynomial.h"

#include <algorithm>

namespace tandem::geometry {

namespace {

using Path = Vector<Polynomial>;
using Paths = std::array<Path, 4>;

/// A contact of two features at any time when every polynomial of `zero` is zero, none of `least` is
/// negative, and `positive` is positive.
struct FeatureContact {
    std::vector<Polynomial> zero, least;
    Polynomial positive;

    bool is_at(const Root& time) const {
        return std::ranges::all_of(zero, [&](const auto& f) { return time.sign_of(f) == 0; })
               && std::ranges::all_of(least, [&](const auto& g) { return time.sign_of(g) >= 0; })
               && time.sign_of(positive) > 0;
    }
    /// At a root of an equation that is not zero at all times. Without one the answer is no, because a
    /// contact of smaller features begins then.
    bool happens() const {
        if (std::ranges::any_of(least, [](const auto& g) { return sign_on(g) < 0; })) return false;
        const auto f = std::ranges::find_if(zero, [](const auto& g) { return !g.is_zero(); });
        if (f == zero.end()) return false;
        return std::ranges::any_of(roots_in_unit(*f), [&](const Root& time) { return is_at(time); });
    }
};

bool is_never_zero(const Polynomial& p) { return sign_on(p) != 0; }

/// A corner on a closed triangle that has an area.
bool is_on_face(const Path& p, const Path& a, const Path& b, const Path& c) {
    const auto normal = cross(minus(b, a), minus(c, a));
    auto height = dot(normal, minus(p, a));
    if (is_never_zero(height)) return false;
    FeatureContact contact{{std::move(height)}, {}, dot(normal, normal)};
    for (const auto& [from, to] : {std::pair{&a, &b}, {&b, &c}, {&c, &a}})
        contact.least.push_back(dot(normal, cross(minus(*to, *from), minus(p, *from))));
    return contact.happens();
}

/// Two closed edges that cross, and are not parallel, at a + t (b - a) = c + u (d - c). The numerators of t
/// and u have the denominator m . m, where m is the product of the edges.
bool edges_cross(const Path& a, const Path& b, const Path& c, const Path& d) {
    const auto one = minus(b, a), other = minus(d, c), between = minus(c, a);
    const auto m = cross(one, other);
    auto distance = dot(m, between);
    if (is_never_zero(distance)) return false;
    const auto whole = dot(m, m);
    const auto t = dot(cross(between, other), m), u = dot(cross(between, one), m);
    return FeatureContact{{std::move(distance)}, {t, whole - t, u, whole - u}, whole}.happens();
}

/// A corner on a closed edge that has a length.
bool is_on_edge(const Path& p, const Path& a, const Path& b) {
    const auto edge = minus(b, a), from = minus(p, a);
    auto off = cross(edge, from);
    if (std::ranges::any_of(off, is_never_zero)) return false;
    const auto along = dot(edge, from), whole = dot(edge, edge);
    return FeatureContact{{off[0], off[1], off[2]}, {along, whole - along}, whole}.happens();
}

/// Corners that are equal at some time, but not at all times.
bool are_equal_once(const Path& p, const Path& q) {
    const auto off = minus(p, q);
    if (std::ranges::any_of(off, is_never_zero)) return false;
    return FeatureContact{{off[0], off[1], off[2]}, {}, Polynomial({1})}.happens();
}

/// A corner of `corners` on a face or an edge of the other one.
bool any_corner_on(const Paths& corners, const Paths& other) {
    return std::ranges::any_of(corners, [&](const Path& p) {
        return std::ranges::any_of(
                   faces, [&](const auto& f) { return is_on_face(p, other[f[0]], other[f[1]], other[f[2]]); })
               || std::ranges::any_of(
                   edges, [&](const Edge& e) { return is_on_edge(p, other[e.from], other[e.to]); });
    });
}

/// Exact paths of both in common units, relative to the path of a's first corner.
std::array<Paths, 2> paths_of(const MovingTetra& a, const MovingTetra& b) {
    std::vector<std::array<double, 3>> points;
    for (const auto* corners : {&a.from, &b.from, &a.to, &b.to})
        points.insert(points.end(), corners->begin(), corners->end());
    const auto lattice = lattice_points(points).points;
    std::array<Paths, 2> result;
    for (unsigned body = 0; body < 2; ++body)
        for (unsigned i = 0; i < 4; ++i)
            for (unsigned axis = 0; axis < 3; ++axis) {
                const mpz_class from = lattice[4 * body + i][axis] - lattice[0][axis];
                const mpz_class to = lattice[8 + 4 * body + i][axis] - lattice[8][axis];
                result[body][i][axis] = Polynomial({from, to - from});
            }
    return result;
}

} // namespace

bool meet_on_straight_paths(const MovingTetra& moving_a, const MovingTetra& moving_b) {
    const auto [a, b] = paths_of(moving_a, moving_b);
    for (const auto& e : edges)
        for (const auto& f : edges)
            if (edges_cross(a[e.from], a[e.to], b[f.from], b[f.to])) return true;
    for (const auto& p : a)
        for (const auto& q : b)
            if (are_equal_once(p, q)) return true;
    return any_corner_on(a, b) || any_corner_on(b, a);
}

} // namespace tandem::geometry
