// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_axes.h"

namespace tandem::narrow_phase {

namespace {

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

} // namespace

template<class Real>
std::vector<Contact<Real>> growth_contacts(const ReferencePair<Real>& pair, const Boundaries&) {
    if (concentric(pair)) {
        const auto [normal, overlap] = least_translation(pair, all_faces);
        return contacts_along(pair, normal, -overlap);
    }
    const auto normal = growth_normal(pair);
    const auto [low_a, high_a, low_b, high_b] = pair.extents(normal);
    return contacts_along(pair, normal, -(high_a - low_b));
}

TANDEM_REFERENCE_OF(growth)

} // namespace tandem::narrow_phase
