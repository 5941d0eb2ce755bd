// SPDX-License-Identifier: MIT
#include "geometry/exact_contact.h"

#include "geometry/lattice.h"
#include "geometry/rounding.h"

namespace tandem::geometry {

namespace {

/// The square of a facet's distance from the origin.
mpq_class squared(const Facet<mpz_class>& facet) {
    mpq_class result(facet.gap * facet.gap, dot(facet.normal, facet.normal));
    result.canonicalize();
    return result;
}

/// Sets the depth and its normals. The depth is the distance of the origin from the nearest facet of the
/// difference A - B. It is a square in lattice units until the last line. Each facet within the slack gives
/// one normal.
void set_separation(const Lattice<mpz_class>& lattice, double slack, ExactContact& result) {
    std::vector<std::pair<mpq_class, Vector<mpz_class>>> facets;
    for_each_facet(lattice.a, lattice.b, all_facets, [&](Facet<mpz_class> facet) {
        auto depth = squared(facet);
        if (facets.empty() || depth < result.depth_squared) result.depth_squared = depth;
        facets.emplace_back(std::move(depth), std::move(facet.normal));
        return true;
    });
    const mpq_class factor = 1 + mpq_class(slack);
    for (auto& [depth, normal] : facets)
        if (depth <= factor * factor * result.depth_squared) result.normals.push_back(std::move(normal));
    result.depth_squared = scaled(result.depth_squared, 2 * lattice.exponent);
}

} // namespace

std::optional<ExactContact> exact_contact(const TetraCorners& a, const TetraCorners& b, double slack) {
    ExactContact result;
    result.relation = tandem::relation(a, b);
    if (result.relation == Relation::invalid) return std::nullopt;
    const auto lattice = big_lattice(a, b);
    if (orientation(lattice.a) == 0 || orientation(lattice.b) == 0) return std::nullopt;
    if (result.relation == Relation::disjoint) return result;
    set_separation(lattice, slack, result);
    result.vertices = intersection_vertices(lattice.a, lattice.b);
    result.volume = scaled(intersection_volume(lattice.a, lattice.b, result.vertices), 3 * lattice.exponent);
    for (auto& vertex : result.vertices)
        for (unsigned axis = 0; axis < 3; ++axis)
            vertex[axis] = scaled(vertex[axis], lattice.exponent) + mpq_class(a[0][axis]);
    return result;
}

} // namespace tandem::geometry
