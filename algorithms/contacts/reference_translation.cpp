// SPDX-License-Identifier: MIT
// Rules sat and clip.
#include "algorithms/contacts/reference_pair.h"

namespace tandem::contact_reference {

namespace {

template<class Real>
struct Translation {
    Vector<Real> normal{};
    Real overlap = std::numeric_limits<Real>::infinity();
};

template<class Real>
Translation<Real> least_translation(const ReferencePair<Real>& pair) {
    Translation<Real> best;
    const auto consider = [&](const Vector<Real>& n) {
        const auto [low_a, high_a, low_b, high_b] = pair.extents(n);
        if (high_a - low_b < best.overlap) best = {n, high_a - low_b};
        if (high_b - low_a < best.overlap) best = {n * Real(-1), high_b - low_a};
    };
    for (const auto& n : pair.solids[0].normals) consider(n);
    for (const auto& n : pair.solids[1].normals) consider(n * Real(-1));
    for (const auto& [i, j] : edge_ends)
        for (const auto& [k, l] : edge_ends) {
            const auto n = cross((pair.world[0][j] - pair.world[0][i]) * pair.scale,
                                 (pair.world[1][l] - pair.world[1][k]) * pair.scale);
            if (largest(n) >= ReferencePair<Real>::shortest) consider(unit(n));
        }
    return best;
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

/// The direction in which the common volume shrinks fastest, unless it has none.
template<class Real>
std::optional<Vector<Real>> area_normal(const ReferencePair<Real>& pair) {
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

} // namespace

template<class Real>
std::vector<Contact<Real>> translation_contacts(const ReferencePair<Real>& pair, bool clip) {
    const auto meetings = pair.meetings();
    const auto [least_normal, overlap] = least_translation(pair);
    auto normal = least_normal;
    Real depth = -overlap;
    if (clip && overlap > pair.tolerance())
        if (const auto n = area_normal(pair)) {
            normal = *n;
            std::vector<Real> heights;
            heights.reserve(meetings.size());
            for (const auto& meeting : meetings)
                heights.push_back(dot(normal, meeting.point - pair.solids[0].corners[0]));
            depth = 0;
            if (!heights.empty()) {
                const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
                depth = -(*high - *low);
            }
        }
    std::vector<Contact<Real>> result;
    result.reserve(meetings.size());
    for (const auto& meeting : meetings) result.push_back(pair.contact(meeting, normal, depth));
    return result;
}

template std::vector<Contact<float>> translation_contacts(const ReferencePair<float>&, bool);
template std::vector<Contact<double>> translation_contacts(const ReferencePair<double>&, bool);

} // namespace tandem::contact_reference
