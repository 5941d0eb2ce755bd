// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_axes.h"

namespace tandem::narrow_phase {

namespace {

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
std::vector<Contact<Real>> clip_contacts(const ReferencePair<Real>& pair, const Boundaries&) {
    auto [normal, overlap] = least_translation(pair, all_faces);
    // A common volume as thin as rounding has no direction of its own.
    if (overlap > pair.tolerance())
        if (const auto n = area_normal(pair)) {
            normal = *n;
            overlap = extent(pair, pair.shared_points(), normal);
        }
    return contacts_along(pair, normal, -overlap);
}

TANDEM_REFERENCE_OF(clip)

} // namespace tandem::narrow_phase
