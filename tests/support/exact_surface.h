// SPDX-License-Identifier: MIT
// The surface of the common part of two tetrahedra in rationals, which contact rule `clip` follows.
#pragma once

#include "geometry/exact_contact.h"
#include "geometry/lattice.h"
#include "geometry/rounding.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace tandem::support {

/// Lengths are in units of 2^exponent. Every number is rounded once, from a rational.
class ExactSurface {
public:
    /// Both must have volume.
    ExactSurface(const TetraCorners& a, const TetraCorners& b) {
        const auto lattice = geometry::big_lattice(a, b);
        unit_ = std::ldexp(1.0, lattice.exponent);
        vertices_ = geometry::intersection_vertices(lattice.a, lattice.b);
        geometry::RationalPoint of_a, of_b;
        for (unsigned face = 0; face < 4; ++face) {
            add(of_a, lattice.a, face);
            add(of_b, lattice.b, face);
        }
        for (unsigned k = 0; k < 3; ++k) normal[k] = geometry::nearest(of_a[k]) * unit_ * unit_;
        is_sure = of_a[0] + of_b[0] == 0 && of_a[1] + of_b[1] == 0 && of_a[2] + of_b[2] == 0;
    }

    /// Extent of the common part along a direction, times the direction's length.
    double extent(const std::array<double, 3>& along) const {
        mpq_class low, high;
        for (std::size_t i = 0; i < vertices_.size(); ++i) {
            mpq_class height = 0;
            for (unsigned k = 0; k < 3; ++k) height += vertices_[i][k] * mpq_class(along[k]);
            if (i == 0 || height < low) low = height;
            if (i == 0 || height > high) high = height;
        }
        return geometry::nearest(mpq_class(high - low)) * unit_;
    }

    std::array<double, 3> normal{}; ///< the sum of the area vectors of A's faces inside B
    double total = 0;               ///< area of the whole surface
    bool is_sure = false;           ///< no face of one lies in a face of the other, on the same side

private:
    /// Adds the area vector of the part of a face that is inside the other tetrahedron.
    void add(geometry::RationalPoint& sum, const geometry::Points<mpz_class>& solid, unsigned face) {
        using namespace geometry;
        const auto& p = solid[faces[face][0]];
        auto axis = cross(minus(solid[faces[face][1]], p), minus(solid[faces[face][2]], p));
        if (sign(dot(axis, minus(solid[face], p))) > 0) axis = minus(Vector<mpz_class>{0, 0, 0}, axis);
        const unsigned drop = axis[0] != 0 ? 0 : axis[1] != 0 ? 1 : 2;
        const mpz_class offset = dot(axis, p);
        std::vector<std::array<mpq_class, 2>> polygon;
        for (const auto& vertex : vertices_)
            if (dot(RationalPoint{axis[0], axis[1], axis[2]}, vertex) == offset)
                polygon.push_back({vertex[(drop + 1) % 3], vertex[(drop + 2) % 3]});
        if (polygon.size() < 3) return;
        const mpq_class projected = area(polygon);
        mpq_class square = 0;
        for (unsigned k = 0; k < 3; ++k) {
            const mpq_class part = projected * axis[k] / abs(axis[drop]);
            sum[k] += part;
            square += part * part;
        }
        total += nearest_root(square) * unit_ * unit_;
    }

    /// Area of the convex polygon with these corners.
    static mpq_class area(std::vector<std::array<mpq_class, 2>>& polygon) {
        const auto turn = [&](const auto& p, const auto& q) -> mpq_class {
            const auto& o = polygon.front();
            return (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
        };
        std::iter_swap(polygon.begin(), std::min_element(polygon.begin(), polygon.end()));
        std::sort(polygon.begin() + 1, polygon.end(),
                  [&](const auto& p, const auto& q) { return turn(p, q) > 0; });
        mpq_class sum = 0;
        for (std::size_t i = 2; i < polygon.size(); ++i) sum += turn(polygon[i - 1], polygon[i]);
        return abs(sum) / 2;
    }

    std::vector<geometry::RationalPoint> vertices_;
    double unit_ = 1;
};

} // namespace tandem::support
