// SPDX-License-Identifier: MIT
#include "geometry/exact_contact.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace tandem::geometry {

namespace {

/// The plane of a face; interior points have normal . x <= offset.
struct Plane {
    Vector<mpz_class> normal;
    mpz_class offset;
};

/// Normals point away from the opposite corner, so the order of the corners does not matter.
std::array<Plane, 4> planes(const Points<mpz_class>& corners) {
    std::array<Plane, 4> result;
    for (unsigned i = 0; i < 4; ++i) {
        const auto& p = corners[faces[i][0]];
        auto normal = cross(minus(corners[faces[i][1]], p), minus(corners[faces[i][2]], p));
        if (sign(dot(normal, minus(corners[i], p))) > 0) normal = minus(Vector<mpz_class>{0, 0, 0}, normal);
        mpz_class offset = dot(normal, p);
        result[i] = {std::move(normal), std::move(offset)};
    }
    return result;
}

/// The part [low, high] of the segment p + t (q - p), 0 <= t <= 1, on the inner side of all planes.
std::optional<std::pair<mpq_class, mpq_class>> clip(const Vector<mpz_class>& p, const Vector<mpz_class>& q,
                                                    const std::array<Plane, 4>& planes) {
    mpq_class low = 0, high = 1;
    for (const auto& plane : planes) {
        const mpz_class at_p = dot(plane.normal, p) - plane.offset;
        const mpz_class at_q = dot(plane.normal, q) - plane.offset;
        if (at_p > 0 && at_q > 0) return std::nullopt;
        if (at_p <= 0 && at_q <= 0) continue;
        mpq_class t(at_p, at_p - at_q);
        t.canonicalize();
        if (at_p > 0) low = std::max(low, t);
        if (at_q > 0) high = std::min(high, t);
    }
    if (low > high) return std::nullopt;
    return std::pair{low, high};
}

/// Adds the ends of the part of each edge that lies in the other tetrahedron, given by its planes. An edge
/// that only touches it adds one point twice.
void add_ends(const Points<mpz_class>& corners, const std::array<Plane, 4>& other,
              std::vector<RationalPoint>& vertices) {
    for (const auto& edge : edges) {
        const auto& p = corners[edge.from];
        const auto along = minus(corners[edge.to], p);
        const auto part = clip(p, corners[edge.to], other);
        if (!part) continue;
        for (const auto& t : {part->first, part->second}) {
            RationalPoint point;
            for (unsigned axis = 0; axis < 3; ++axis) point[axis] = p[axis] + t * along[axis];
            vertices.push_back(std::move(point));
        }
    }
}

/// Sorts the vertices of a convex polygon around its lowest vertex; `normal` belongs to its plane.
void sort_around(std::vector<RationalPoint>& polygon, const Vector<mpz_class>& normal) {
    // A projection along an axis with a non-zero component of the normal keeps the polygon convex and
    // two-dimensional.
    const unsigned drop = normal[0] != 0 ? 0 : normal[1] != 0 ? 1 : 2;
    const unsigned u = (drop + 1) % 3, v = (drop + 2) % 3;
    std::sort(polygon.begin(), polygon.end(),
              [=](const auto& p, const auto& q) { return std::tie(p[u], p[v]) < std::tie(q[u], q[v]); });
    const auto first = polygon.front();
    std::sort(polygon.begin() + 1, polygon.end(), [&](const auto& p, const auto& q) {
        return (p[u] - first[u]) * (q[v] - first[v]) > (p[v] - first[v]) * (q[u] - first[u]);
    });
}

/// Six times the volume of the pyramid over a polygon.
mpq_class pyramid(const std::vector<RationalPoint>& polygon, const RationalPoint& apex) {
    mpq_class sum = 0;
    const auto first = minus(polygon[0], apex);
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        const mpq_class part = dot(cross(first, minus(polygon[i - 1], apex)), minus(polygon[i], apex));
        sum += abs(part);
    }
    return sum;
}

} // namespace

std::vector<RationalPoint> intersection_vertices(const Points<mpz_class>& a, const Points<mpz_class>& b) {
    std::vector<RationalPoint> vertices;
    add_ends(a, planes(b), vertices);
    add_ends(b, planes(a), vertices);
    const auto before = [](const auto& p, const auto& q) {
        return std::tie(p[0], p[1], p[2]) < std::tie(q[0], q[1], q[2]);
    };
    std::sort(vertices.begin(), vertices.end(), before);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

mpq_class intersection_volume(const Points<mpz_class>& a, const Points<mpz_class>& b,
                              const std::vector<RationalPoint>& vertices) {
    mpq_class sum = 0;
    std::vector<std::vector<RationalPoint>> counted; // coplanar faces of A and of B have one polygon
    for (const auto& corners : {a, b})
        for (const auto& plane : planes(corners)) {
            const RationalPoint normal{plane.normal[0], plane.normal[1], plane.normal[2]};
            std::vector<RationalPoint> polygon;
            for (const auto& vertex : vertices)
                if (dot(normal, vertex) == plane.offset) polygon.push_back(vertex);
            if (polygon.size() < 3 || std::find(counted.begin(), counted.end(), polygon) != counted.end())
                continue;
            counted.push_back(polygon);
            sort_around(polygon, plane.normal);
            sum += pyramid(polygon, vertices.front());
        }
    return sum / 6;
}

} // namespace tandem::geometry
