// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

namespace tandem::geometry {

/// An edge of a tetrahedron, and the two other corners.
struct Edge {
    unsigned from, to;
    std::array<unsigned, 2> opposite;
};
constexpr std::array<Edge, 6> edges{
    {{0, 1, {2, 3}}, {0, 2, {1, 3}}, {0, 3, {1, 2}}, {1, 2, {0, 3}}, {1, 3, {0, 2}}, {2, 3, {0, 1}}}};

/// Corners of the face opposite corner i, ascending.
constexpr std::array<std::array<unsigned, 3>, 4> faces{{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

/// A set of candidate facets. Bit i is face i of A, and bit 4 + i is face i of B. Bit 8 + 6 i + j is the
/// product of edge i of A and edge j of B.
using FacetSet = std::uint64_t;
/// 8 faces and 36 products of edges.
constexpr FacetSet all_facets = (FacetSet{1} << 44) - 1;
constexpr FacetSet face_bit(unsigned body, unsigned face) { return FacetSet{1} << (4 * body + face); }
constexpr FacetSet edges_bit(unsigned a, unsigned b) { return FacetSet{1} << (8 + 6 * a + b); }

template<class Number>
using Vector = std::array<Number, 3>;
template<class Number>
using Points = std::array<Vector<Number>, 4>;

template<class Number>
Vector<Number> minus(const Vector<Number>& p, const Vector<Number>& q) {
    return {Number(p[0] - q[0]), Number(p[1] - q[1]), Number(p[2] - q[2])};
}

template<class Number>
Vector<Number> cross(const Vector<Number>& p, const Vector<Number>& q) {
    return {Number(p[1] * q[2] - p[2] * q[1]), Number(p[2] * q[0] - p[0] * q[2]),
            Number(p[0] * q[1] - p[1] * q[0])};
}

template<class Number>
Number dot(const Vector<Number>& p, const Vector<Number>& q) {
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

template<class Number>
int sign(const Number& x) {
    return x > 0 ? 1 : x < 0 ? -1 : 0;
}

/// A facet of the Minkowski difference A - B of two tetrahedra with volume. The closed sets are disjoint when
/// any gap is positive, touch when the largest gap is zero, and overlap when all gaps are negative.
template<class Number>
struct Facet {
    Vector<Number> normal; ///< out of A; not of unit length
    Number gap;            ///< min over B of normal . x - max over A
};

/// The facet for a face of A. A must have volume.
template<class Number>
Facet<Number> face_facet(const Points<Number>& a, const Points<Number>& b, unsigned face) {
    const auto& p = a[faces[face][0]];
    auto normal = cross(minus(a[faces[face][1]], p), minus(a[faces[face][2]], p));
    if (sign(dot(normal, minus(a[face], p))) > 0) normal = minus(Vector<Number>{0, 0, 0}, normal);
    Number gap = dot(normal, minus(b[0], p));
    for (unsigned i = 1; i < 4; ++i) {
        Number other = dot(normal, minus(b[i], p));
        if (other < gap) gap = std::move(other);
    }
    return {std::move(normal), std::move(gap)};
}

/// The facet for an edge of A and an edge of B, if it exists. It exists exactly when a direction
/// perpendicular to both edges has its maximum over A on A's edge only and its minimum over B on B's edge
/// only. When more of A or B is level with the edge, the facet belongs to a face. Parallel edges have no
/// facet.
template<class Number>
std::optional<Facet<Number>> edges_facet(const Points<Number>& a, const Points<Number>& b, unsigned edge_a,
                                         unsigned edge_b) {
    const auto& ea = edges[edge_a];
    const auto& eb = edges[edge_b];
    const auto& p = a[ea.from];
    const auto& q = b[eb.from];
    auto normal = cross(minus(a[ea.to], p), minus(b[eb.to], q));
    const int side = sign(dot(normal, minus(a[ea.opposite[0]], p)));
    if (side == 0 || sign(dot(normal, minus(a[ea.opposite[1]], p))) != side) return std::nullopt;
    for (const auto other : eb.opposite)
        if (sign(dot(normal, minus(b[other], q))) != -side) return std::nullopt;
    if (side > 0) normal = minus(Vector<Number>{0, 0, 0}, normal);
    Number gap = dot(normal, minus(q, p));
    return Facet<Number>{std::move(normal), std::move(gap)};
}

/// The sign of the volume; 0 when the corners lie in one plane.
template<class Number>
int orientation(const Points<Number>& p) {
    return sign(dot(cross(minus(p[1], p[0]), minus(p[2], p[0])), minus(p[3], p[0])));
}

/// Calls visit(facet) for each facet of A - B in `set` until it returns false. May also visit facets that do
/// not affect the result. Normals point from A to B. Both tetrahedra must have volume.
template<class Number, class Visit>
void for_each_facet(const Points<Number>& a, const Points<Number>& b, FacetSet set, Visit visit) {
    for (unsigned i = 0; i < 4; ++i)
        if ((set & face_bit(0, i)) != 0 && !visit(face_facet(a, b, i))) return;
    for (unsigned i = 0; i < 4; ++i) {
        if ((set & face_bit(1, i)) == 0) continue;
        auto facet = face_facet(b, a, i);
        facet.normal = minus(Vector<Number>{0, 0, 0}, facet.normal);
        if (!visit(std::move(facet))) return;
    }
    for (unsigned i = 0; i < 6; ++i)
        for (unsigned j = 0; j < 6; ++j) {
            if ((set & edges_bit(i, j)) == 0) continue;
            auto facet = edges_facet(a, b, i, j);
            if (facet && !visit(std::move(*facet))) return;
        }
}

} // namespace tandem::geometry
