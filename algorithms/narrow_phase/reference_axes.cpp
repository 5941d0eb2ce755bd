// SPDX-License-Identifier: MIT
// Rules sat, restricted, clip and growth, which have one normal and one depth per pair.
#include "algorithms/narrow_phase/reference_pair.h"

namespace tandem::contact_reference {

namespace {

/// The best axis so far: the one with the least measure.
template<class Real>
struct Best {
    Vector<Real> normal{};
    Real measure = std::numeric_limits<Real>::infinity();

    void consider(const Vector<Real>& n, Real value) {
        if (value < measure) *this = {n, value};
    }
};

/// Calls visit with the unit normals of faces, out of A, and the unit cross products of edges. Only boundary
/// faces and their edges count.
template<class Real, class Visit>
void for_each_axis(const ReferencePair<Real>& pair, const Boundaries& boundaries, Visit visit) {
    const auto has_edge = [&](unsigned solid, unsigned edge) {
        for (unsigned face = 0; face < 4; ++face)
            if ((boundaries[solid] & 1u << face) != 0 && face != edge_ends[edge][0]
                && face != edge_ends[edge][1])
                return true;
        return false;
    };
    for (unsigned solid = 0; solid < 2; ++solid)
        for (unsigned face = 0; face < 4; ++face)
            if ((boundaries[solid] & 1u << face) != 0)
                visit(pair.solids[solid].normals[face] * Real(solid == 0 ? 1 : -1));
    for (unsigned p = 0; p < 6; ++p)
        for (unsigned q = 0; q < 6; ++q) {
            if (!has_edge(0, p) || !has_edge(1, q)) continue;
            const auto& [i, j] = edge_ends[p];
            const auto& [k, l] = edge_ends[q];
            const auto n = cross((pair.world[0][j] - pair.world[0][i]) * pair.scale,
                                 (pair.world[1][l] - pair.world[1][k]) * pair.scale);
            if (largest(n) >= ReferencePair<Real>::shortest) visit(unit(n));
        }
}

/// For rules that use every face of a tetrahedron, whatever its mesh.
constexpr Boundaries all_faces{15, 15};

/// The axis with the least translation as its measure. Without boundary faces there is no axis, and the
/// measure is infinite.
template<class Real>
Best<Real> least_translation(const ReferencePair<Real>& pair, const Boundaries& boundaries) {
    Best<Real> best;
    for_each_axis(pair, boundaries, [&](const Vector<Real>& n) {
        const auto [low_a, high_a, low_b, high_b] = pair.extents(n);
        best.consider(n, high_a - low_b);
        best.consider(n * Real(-1), high_b - low_a);
    });
    return best;
}

template<class Real>
Real mean(const std::array<Real, 4>& values) {
    return ((values[0] + values[1]) + (values[2] + values[3])) / 4;
}

/// Whether the centres differ by no more than rounding.
template<class Real>
bool concentric(const ReferencePair<Real>& pair) {
    std::array<Vector<Real>, 2> centres;
    for (unsigned solid = 0; solid < 2; ++solid)
        for (unsigned i = 0; i < 3; ++i) {
            const auto& c = pair.solids[solid].corners;
            centres[solid][i] = mean<Real>({c[0][i], c[1][i], c[2][i], c[3][i]});
        }
    return largest(centres[1] - centres[0]) <= pair.tolerance();
}

/// The normal where the two touch first when they grow about their centres. The measure is minus the growth.
template<class Real>
Vector<Real> growth_normal(const ReferencePair<Real>& pair) {
    Best<Real> best{pair.solids[0].normals[0]};
    for_each_axis(pair, all_faces, [&](const Vector<Real>& n) {
        const auto [low_a, high_a, low_b, high_b] = pair.extents(n);
        std::array<Real, 2> centres;
        for (unsigned solid = 0; solid < 2; ++solid) {
            const auto& c = pair.solids[solid].corners;
            centres[solid] = mean<Real>({dot(n, c[0]), dot(n, c[1]), dot(n, c[2]), dot(n, c[3])});
        }
        const auto [a, b] = centres;
        const Real extent = b < a ? (a - low_a) + (high_b - b) : (high_a - a) + (b - low_b);
        if (extent > 0) best.consider(n * Real(b < a ? -1 : 1), -(std::abs(b - a) / extent));
    });
    return best.normal;
}

/// Area of A's face inside B.
template<class Real>
Real area_inside(const ReferencePair<Real>& pair, unsigned face) {
    const auto& [solid, other] = pair.solids;
    std::vector<Vector<Real>> polygon;
    for (const auto corner : face_corners[face]) polygon.push_back(solid.corners[corner]);
    for (unsigned plane = 0; plane < 4; ++plane) {
        std::vector<Vector<Real>> rest;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const auto& p = polygon[i];
            const auto& q = polygon[(i + 1) % polygon.size()];
            const Real from = other.distance(plane, p);
            const Real to = other.distance(plane, q);
            if (from <= 0) rest.push_back(p);
            if ((from <= 0) != (to <= 0)) rest.push_back(p + (q - p) * (from / (from - to)));
        }
        polygon = rest;
    }
    Real area = 0;
    for (std::size_t i = 2; i < polygon.size(); ++i)
        area += dot(solid.normals[face], cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]));
    return std::abs(area) / 2;
}

/// Whether one of the two has no corner outside the other.
template<class Real>
bool nested(const ReferencePair<Real>& pair) {
    const auto has_all = [&pair](const Tetrahedron<Real>& outer, const Tetrahedron<Real>& inner) {
        return std::ranges::all_of(inner.corners, [&](const Vector<Real>& corner) {
            return pair.inside(outer, corner, 4, pair.tolerance());
        });
    };
    return has_all(pair.solids[0], pair.solids[1]) || has_all(pair.solids[1], pair.solids[0]);
}

/// The direction in which the common volume shrinks fastest; empty if there is none.
template<class Real>
std::optional<Vector<Real>> area_normal(const ReferencePair<Real>& pair) {
    if (nested(pair)) return std::nullopt;
    Vector<Real> sum{};
    Real total = 0;
    for (unsigned face = 0; face < 4; ++face) {
        const Real area = area_inside(pair, face);
        sum = sum + pair.solids[0].normals[face] * area;
        total += area;
    }
    if (largest(sum) <= total / 128 || largest(sum) < ReferencePair<Real>::shortest) return std::nullopt;
    return unit(sum);
}

/// Extent of the points along the normal.
template<class Real>
Real extent(const ReferencePair<Real>& pair, const std::vector<SharedPoint<Real>>& shared_points,
            const Vector<Real>& normal) {
    if (shared_points.empty()) return 0;
    std::vector<Real> heights;
    heights.reserve(shared_points.size());
    for (const auto& shared : shared_points)
        heights.push_back(dot(normal, shared.point - pair.solids[0].corners[0]));
    const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
    return *high - *low;
}

} // namespace

template<class Real>
std::vector<Contact<Real>> axis_contacts(const ReferencePair<Real>& pair, ContactRule rule,
                                         const Boundaries& boundaries) {
    const bool restricted = rule == ContactRule::restricted;
    if (restricted && boundaries == Boundaries{}) return {};
    const auto shared_points = pair.shared_points();
    auto [normal, overlap] = least_translation(pair, restricted ? boundaries : all_faces);
    // A common volume as thin as rounding has no direction of its own.
    if (rule == ContactRule::clip && overlap > pair.tolerance())
        if (const auto n = area_normal(pair)) {
            normal = *n;
            overlap = extent(pair, shared_points, normal);
        }
    if (rule == ContactRule::growth && !concentric(pair)) {
        normal = growth_normal(pair);
        const auto [low_a, high_a, low_b, high_b] = pair.extents(normal);
        overlap = high_a - low_b;
    }
    std::vector<Contact<Real>> result;
    result.reserve(shared_points.size());
    for (const auto& shared : shared_points) result.push_back(pair.contact(shared, normal, -overlap));
    return result;
}

template std::vector<Contact<float>> axis_contacts(const ReferencePair<float>&, ContactRule,
                                                   const Boundaries&);
template std::vector<Contact<double>> axis_contacts(const ReferencePair<double>&, ContactRule,
                                                    const Boundaries&);

} // namespace tandem::contact_reference
