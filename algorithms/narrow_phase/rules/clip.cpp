// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_axes.h"
#include "algorithms/narrow_phase/reference_surface.h"

namespace tandem::narrow_phase {

namespace {

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

/// The direction in which the common volume shrinks fastest, and the extent along it; empty if there is none.
template<class Real>
std::optional<Best<Real>> by_common_surface(const ReferencePair<Real>& pair) {
    for (const bool precise : {false, true}) {
        const Clipping<Real> clipping(pair, precise);
        const auto surface = clipping.surface();
        const auto sum = values(surface.sum);
        const Real size = length(sum);
        if ((size + surface.error) * 128 <= surface.total - surface.error) return std::nullopt;
        if (surface.error * 32 > size || (size - surface.error) * 128 <= surface.total + surface.error)
            continue;
        const auto normal = unit(sum);
        return Best<Real>{normal, clipping.extent(normal)};
    }
    return std::nullopt;
}

} // namespace

template<class Real>
std::vector<Contact<Real>> clip_contacts(const ReferencePair<Real>& pair, const Boundaries&) {
    auto [normal, overlap] = least_translation(pair, all_faces);
    // A common volume as thin as rounding has no direction of its own.
    if (overlap > pair.tolerance() && !nested(pair))
        if (const auto best = by_common_surface(pair)) {
            normal = best->normal;
            overlap = best->measure;
        }
    return contacts_along(pair, normal, -overlap);
}

TANDEM_REFERENCE_OF(clip)

} // namespace tandem::narrow_phase
