// SPDX-License-Identifier: MIT
#include "geometry/exact_polygon.h"

#include "geometry/lattice.h"
#include "geometry/rounding.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace tandem {

namespace {

using namespace geometry;
using Integers = Vector<mpz_class>;
using Rationals = Vector<mpq_class>;
using Polygon = std::vector<Rationals>;

Rationals rational(const Integers& p) { return {mpq_class(p[0]), mpq_class(p[1]), mpq_class(p[2])}; }

Rationals added(const Rationals& p, const mpq_class& factor, const Rationals& q) {
    return {mpq_class(p[0] + factor * q[0]), mpq_class(p[1] + factor * q[1]),
            mpq_class(p[2] + factor * q[2])};
}

/// A linear function by its gradient and its value at a point.
struct Linear {
    Rationals gradient{}, at;
    mpq_class value;

    mpq_class operator()(const Rationals& p) const { return value + dot(gradient, minus(p, at)); }
};

Linear pressure_of(const Points<mpz_class>& solid, const std::array<double, 4>& values) {
    Linear field{{}, rational(solid[0]), mpq_class(values[0])};
    for (unsigned i = 1; i < 4; ++i) {
        const auto& [first, second, third] = faces[i];
        const auto normal =
            rational(cross(minus(solid[second], solid[first]), minus(solid[third], solid[first])));
        const mpq_class height = dot(normal, rational(minus(solid[i], solid[first])));
        field.gradient =
            added(field.gradient, (mpq_class(values[i]) - mpq_class(values[0])) / height, normal);
    }
    return field;
}

/// Twice the height of a face's plane, positive outside.
Linear outside(const Points<mpz_class>& solid, unsigned face) {
    const auto& [first, second, third] = faces[face];
    auto normal = rational(cross(minus(solid[second], solid[first]), minus(solid[third], solid[first])));
    if (dot(normal, rational(minus(solid[face], solid[first]))) > 0)
        normal = minus(Rationals{0, 0, 0}, normal);
    return {normal, rational(solid[first]), 0};
}

/// Appends the point of the edge from p to q where the function is 0, which has other signs at the two.
void cross_edge(const Rationals& p, const Rationals& q, const mpq_class& at_p, const mpq_class& at_q,
                Polygon& polygon) {
    polygon.push_back(added(p, at_p / (at_p - at_q), minus(q, p)));
}

/// Whether the plane where the function is 0 goes through the tetrahedron, or through a face with the rest
/// above: of two that share a face, one has it.
bool is_cut(const Points<mpz_class>& solid, const Linear& function) {
    bool is_above = false, is_below = false;
    for (const auto& corner : solid) (function(rational(corner)) > 0 ? is_above : is_below) = true;
    return is_above && is_below;
}

/// The direction along which polygons in faces belong to the tetrahedron above (rules/pressure.clh).
bool is_downward(const Rationals& n) {
    return n[0] + mpq_class(0.7548776662466927) * n[1] + mpq_class(0.5698402909980532) * n[2] < 0;
}

/// The polygon of a tetrahedron where the function is 0, which goes through it. A corner where it is 0 is
/// below.
Polygon plane_cut(const Points<mpz_class>& solid, const Linear& function) {
    Polygon below, above, polygon;
    for (const auto& corner : solid)
        (function(rational(corner)) > 0 ? above : below).push_back(rational(corner));
    for (std::size_t i = 0; i < below.size(); ++i)
        for (std::size_t j = 0; j < above.size(); ++j) {
            // Every second row backwards, so that neighbours share a corner.
            const auto& q = above[i % 2 == 0 ? j : above.size() - 1 - j];
            cross_edge(below[i], q, function(below[i]), function(q), polygon);
        }
    return polygon;
}

/// Without the part where the function is positive.
Polygon clipped(const Polygon& polygon, const Linear& function) {
    Polygon rest;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const auto at_p = function(p), at_q = function(q);
        if (at_p <= 0) rest.push_back(p);
        if ((at_p <= 0) != (at_q <= 0)) cross_edge(p, q, at_p, at_q, rest);
    }
    return rest;
}

/// Whether the angle between the two is at least 5 pi / 8; of a gradient 0 it is not.
bool is_against(const Rationals& normal, const Rationals& gradient) {
    const mpq_class product = dot(normal, gradient);
    if (product >= 0) return false;
    const mpq_class share = product * product / (dot(normal, normal) * dot(gradient, gradient));
    const double sine = std::sin(std::numbers::pi / 8);
    return nearest(share) >= sine * sine;
}

/// p divided by its length.
std::array<double, 3> unit(const Rationals& p) {
    std::array<double, 3> result;
    for (unsigned i = 0; i < 3; ++i) result[i] = sign(p[i]) * nearest_root(p[i] * p[i] / dot(p, p));
    return result;
}

bool is_finite(const std::array<double, 4>& values) {
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

} // namespace

std::optional<ExactPolygon> exact_polygon(const TetraCorners& a, const std::array<double, 4>& of_a,
                                          const TetraCorners& b, const std::array<double, 4>& of_b) {
    if (relation(a, b) == Relation::invalid || !is_finite(of_a) || !is_finite(of_b)) return std::nullopt;
    const auto lattice = big_lattice(a, b);
    if (orientation(lattice.a) == 0 || orientation(lattice.b) == 0) return std::nullopt;
    const auto field_a = pressure_of(lattice.a, of_a), field_b = pressure_of(lattice.b, of_b);
    const auto normal = minus(field_a.gradient, field_b.gradient);
    if (dot(normal, normal) == 0 || is_against(normal, field_a.gradient)
        || is_against(minus(Rationals{0, 0, 0}, normal), field_b.gradient))
        return std::nullopt;
    Linear excess{normal, field_a.at, field_a.value - field_b(field_a.at)};
    if (is_downward(normal)) excess = {minus(Rationals{0, 0, 0}, normal), excess.at, -excess.value};
    if (!is_cut(lattice.a, excess) || !is_cut(lattice.b, excess)) return std::nullopt;
    auto polygon = plane_cut(lattice.a, excess);
    for (unsigned face = 0; face < 4; ++face) polygon = clipped(polygon, outside(lattice.b, face));
    mpq_class twice = 0; // the area along the normal, which is not of length 1
    Rationals moment{0, 0, 0};
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        const auto e = minus(polygon[i - 1], polygon[0]), f = minus(polygon[i], polygon[0]);
        const mpq_class part = dot(cross(e, f), normal);
        twice += part;
        moment = added(added(moment, part, e), part, f);
    }
    if (twice == 0) return std::nullopt;
    const auto centroid = added(polygon[0], 1 / (3 * twice), moment);
    ExactPolygon result;
    result.area = nearest_root(scaled(twice * twice / dot(normal, normal) / 4, 4L * lattice.exponent));
    for (unsigned i = 0; i < 3; ++i)
        result.centroid[i] = nearest(scaled(centroid[i], lattice.exponent) + mpq_class(a[0][i]));
    result.normal = unit(normal);
    result.pressure = nearest(field_a(centroid));
    return result;
}

} // namespace tandem
