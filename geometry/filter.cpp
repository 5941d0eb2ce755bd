// SPDX-License-Identifier: MIT
#include "geometry/filter.h"

#include <algorithm>
#include <cmath>

namespace tandem::geometry {

namespace {

constexpr double relative = 12 * 0x1p-53;
constexpr double absolute = 0x1p-700;
constexpr double largest = 0x1p300;

using Vector3 = Vector<double>;

double taxicab(const Vector3& p) { return std::fabs(p[0]) + std::fabs(p[1]) + std::fabs(p[2]); }

/// A computed cross product, with the sum of the magnitudes of its terms over all components.
struct Normal {
    Vector3 vector;
    double magnitude;
    double slack;  ///< error bound of a component of a factor
    double spread; ///< resulting error bound of the magnitude

    Normal() = default;
    Normal(const Vector3& p, const Vector3& q, double s)
        : slack(s), spread(s * (2 * (taxicab(p) + taxicab(q)) + 6 * s)) {
        const double terms[6] = {p[1] * q[2], p[2] * q[1], p[2] * q[0],
                                 p[0] * q[2], p[0] * q[1], p[1] * q[0]};
        vector = {terms[0] - terms[1], terms[2] - terms[3], terms[4] - terms[5]};
        magnitude = 0;
        for (const double term : terms) magnitude += std::fabs(term);
    }
    /// Error bound of the product with a difference whose components are at most `size`.
    double bound(double size) const {
        return relative * magnitude * size + absolute + (magnitude * slack + spread * (size + slack));
    }
};

/// The sign of x when its error is at most `bound`; 0 when uncertain.
int certain(double x, double bound) { return (x > bound) - (x < -bound); }

/// Edges and face normals of one tetrahedron.
struct Outline {
    std::array<Vector3, 6> edge;
    std::array<Normal, 4> normal; ///< of faces p < q < r: (q - p) x (r - p)
    double size = 0;              ///< largest component of an edge
    int orientation = 0;          ///< certain sign of the volume

    Outline(const TetraCorners& corner, double slack) {
        for (unsigned i = 0; i < 6; ++i) {
            edge[i] = minus(corner[edges[i].to], corner[edges[i].from]);
            for (const double x : edge[i]) size = std::max(size, std::fabs(x));
        }
        normal = {Normal(edge[3], edge[4], slack), Normal(edge[1], edge[2], slack),
                  Normal(edge[0], edge[2], slack), Normal(edge[0], edge[1], slack)};
        orientation = certain(dot(normal[3].vector, edge[2]), normal[3].bound(size));
    }
    /// The side of corner i relative to the normal of its face.
    int inside(unsigned i) const { return i % 2 == 0 ? -orientation : orientation; }
    /// The sign of ((to - from) x (corner opposite[i] - from)) relative to the normal of the face of these
    /// three corners.
    static int parity(unsigned e, unsigned i) {
        const auto k = edges[e].opposite[i];
        return edges[e].from < k && k < edges[e].to ? -1 : 1;
    }
};

/// Certain signs of the products of each face normal of one and each edge of the other.
using Signs = std::array<std::array<int, 6>, 4>;

Signs signs(const Outline& a, const Outline& b) {
    Signs result;
    for (unsigned i = 0; i < 4; ++i) {
        const double bound = a.normal[i].bound(b.size);
        for (unsigned j = 0; j < 6; ++j) result[i][j] = certain(dot(a.normal[i].vector, b.edge[j]), bound);
    }
    return result;
}

double slack_of(double error) { return 2 * error * (1 + 0x1p-40); }

/// The undecided faces of A, one bit each. No value when a face separates the two tetrahedra.
std::optional<FacetSet> try_faces(const Outline& a, const TetraCorners& corners_a,
                                  const TetraCorners& corners_b, double size) {
    FacetSet unsure = 0;
    for (unsigned face = 0; face < 4; ++face) {
        const double bound = a.normal[face].bound(size);
        int outside = 0;
        bool inside = false;
        for (const auto& corner : corners_b) {
            const auto difference = minus(corner, corners_a[faces[face][0]]);
            const int side = certain(dot(a.normal[face].vector, difference), bound) * a.inside(face);
            outside += side < 0;
            inside |= side > 0;
        }
        if (outside == 4) return std::nullopt;
        if (!inside) unsure |= FacetSet{1} << face;
    }
    return unsure;
}

/// What is certain of the facet of A - B at the product n = ea x eb of an edge of A and an edge of B.
struct Side {
    bool possible = true; ///< no two corners certainly contradict each other
    bool certain = true;  ///< the facet exists
    int sign = 0;         ///< of n . x for the rest of A and of -n . x for the rest of B; 0: unknown
};

/// Corner k of A has n . (a_k - a_i) = -((ea x (a_k - a_i)) . eb), a face normal times eb.
Side facet_side(const Signs& on_a, const Signs& on_b, unsigned i, unsigned j) {
    Side result;
    for (unsigned k = 0; k < 2; ++k) {
        const int sides[2] = {-Outline::parity(i, k) * on_a[edges[i].opposite[1 - k]][j],
                              -Outline::parity(j, k) * on_b[edges[j].opposite[1 - k]][i]};
        for (const int side : sides) {
            result.certain &= side != 0;
            result.possible &= side * result.sign != -1;
            if (side != 0) result.sign = side;
        }
    }
    return result;
}

/// The undecided products of edges, bit 6 i + j each. No value when one separates the two tetrahedra.
std::optional<FacetSet> try_products(const Outline& a, const Outline& b, const TetraCorners& corners_a,
                                     const TetraCorners& corners_b, double size, double slack) {
    const auto on_a = signs(a, b);
    const auto on_b = signs(b, a);
    FacetSet unsure = 0;
    for (unsigned i = 0; i < 6; ++i)
        for (unsigned j = 0; j < 6; ++j) {
            const auto side = facet_side(on_a, on_b, i, j);
            if (!side.possible) continue;
            const Normal normal(a.edge[i], b.edge[j], slack);
            const auto between = minus(corners_b[edges[j].from], corners_a[edges[i].from]);
            const int gap = -side.sign * certain(dot(normal.vector, between), normal.bound(size));
            if (gap > 0 && side.certain) return std::nullopt;
            if (gap >= 0) unsure |= FacetSet{1} << (6 * i + j);
        }
    return unsure;
}

/// The largest rounded difference of coordinates along an axis. No other rounded difference is larger.
double extent(const TetraCorners& a, const TetraCorners& b) {
    double size = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
        double low = a[0][axis], high = low;
        for (const auto* corners : {&a, &b})
            for (const auto& corner : *corners) {
                low = std::min(low, corner[axis]);
                high = std::max(high, corner[axis]);
            }
        size = std::max(size, high - low);
    }
    return size;
}

} // namespace

Filtered filter(const TetraCorners& a, const TetraCorners& b, double error) {
    Filtered result;
    const double size = extent(a, b);
    const double slack = slack_of(error);
    if (!(size + slack <= largest)) return result;
    const Outline outline_a(a, slack), outline_b(b, slack);
    result.volume[0] = outline_a.orientation != 0;
    result.volume[1] = outline_b.orientation != 0;
    result.disjoint = true;
    const auto faces_a = try_faces(outline_a, a, b, size);
    if (!faces_a) return result;
    const auto faces_b = try_faces(outline_b, b, a, size);
    if (!faces_b) return result;
    const auto products = try_products(outline_a, outline_b, a, b, size, slack);
    if (!products) return result;
    result.disjoint = false;
    result.unsure = *faces_a | *faces_b << 4 | *products << 8;
    return result;
}

bool certainly_inside(const Vector<double>& point, const TetraCorners& corners, double error) {
    const double size = extent(corners, {point, point, point, point});
    const double slack = slack_of(error);
    if (!(size + slack <= largest)) return false;
    const Outline outline(corners, slack);
    for (unsigned face = 0; face < 4; ++face) {
        const auto& normal = outline.normal[face];
        const auto difference = minus(point, corners[faces[face][0]]);
        if (certain(dot(normal.vector, difference), normal.bound(size)) * outline.inside(face) <= 0)
            return false;
    }
    return true;
}

int certain_orientation(const TetraCorners& corners) {
    const auto u = minus(corners[1], corners[0]);
    const auto v = minus(corners[2], corners[0]);
    const auto w = minus(corners[3], corners[0]);
    double size = 0;
    for (const auto* edge : {&u, &v, &w})
        for (const double x : *edge) size = std::max(size, std::fabs(x));
    if (size > largest) return 0;
    const Normal normal(u, v, 0);
    return certain(dot(normal.vector, w), normal.bound(size));
}

} // namespace tandem::geometry
