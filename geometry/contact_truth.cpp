// SPDX-License-Identifier: MIT
#include "geometry/contact_truth.h"

#include "geometry/exact_contact.h"
#include "geometry/rounding.h"

namespace tandem {

using namespace geometry;

std::optional<ContactTruth> contact_truth(const TetraCorners& a, const TetraCorners& b, double slack) {
    const auto exact = exact_contact(a, b, slack);
    if (!exact) return std::nullopt;
    ContactTruth result;
    result.relation = exact->relation;
    for (const auto& p : exact->vertices)
        result.vertices.push_back({nearest(p[0]), nearest(p[1]), nearest(p[2])});
    result.volume = nearest(exact->volume);
    result.depth = nearest_root(exact->depth_squared);
    result.depth_squared = nearest(exact->depth_squared);
    for (const auto& normal : exact->normals) {
        // Each component is the square root of one rational, rounded once, and no quotient of rounded
        // numbers.
        const mpz_class square = dot(normal, normal);
        auto& unit = result.normals.emplace_back();
        for (unsigned axis = 0; axis < 3; ++axis) {
            mpq_class part(normal[axis] * normal[axis], square);
            part.canonicalize();
            unit[axis] = sign(normal[axis]) * nearest_root(part);
        }
    }
    return result;
}

} // namespace tandem
