// SPDX-License-Identifier: MIT
#include "geometry/volume.h"

#include "geometry/filter.h"
#include "geometry/lattice.h"
#include "geometry/rounding.h"

#include <algorithm>
#include <set>
#include <vector>

namespace tandem {

namespace {

using namespace geometry;

using IntegerPoint = Vector<mpz_class>;

/// Corners, counter-clockwise when viewed from outside.
using Triangle = std::array<std::size_t, 3>;

/// Six times the signed volume of the tetrahedron over a triangle; positive for a point on the inner side.
mpz_class signed_volume(const std::vector<IntegerPoint>& points, const Triangle& t, const IntegerPoint& p) {
    const auto& corner = points[t[0]];
    return -dot(cross(minus(points[t[1]], corner), minus(points[t[2]], corner)), minus(p, corner));
}

bool on_a_line(const IntegerPoint& p, const IntegerPoint& q, const IntegerPoint& r) {
    return cross(minus(q, p), minus(r, p)) == IntegerPoint{0, 0, 0};
}

/// The surface triangles of the first tetrahedron that the points span; empty when all lie in one plane.
std::vector<Triangle> first_hull(const std::vector<IntegerPoint>& points) {
    Triangle base{};
    std::size_t found = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (found == 0 || (found == 1 && points[i] != points[base[0]])
            || (found == 2 && !on_a_line(points[base[0]], points[base[1]], points[i])))
            base[found++] = i;
        else if (found == 3) {
            const int side = sign(signed_volume(points, base, points[i]));
            if (side == 0) continue;
            if (side < 0) std::swap(base[1], base[2]);
            const auto [a, b, c] = base;
            return {{a, b, c}, {a, c, i}, {c, b, i}, {b, a, i}};
        }
    }
    return {};
}

/// Replaces the hull triangles that are visible from point `p` by triangles from their border to `p`.
/// Triangles whose plane contains `p` stay. Thus only whole faces are visible, and no new triangle has its
/// corners on a line.
void add_point(std::vector<Triangle>& hull, const std::vector<IntegerPoint>& points, std::size_t p) {
    std::set<std::pair<std::size_t, std::size_t>> edges;
    const auto visible = [&](const Triangle& t) {
        if (sign(signed_volume(points, t, points[p])) >= 0) return false;
        for (unsigned i = 0; i < 3; ++i) edges.emplace(t[i], t[(i + 1) % 3]);
        return true;
    };
    std::erase_if(hull, visible);
    for (const auto& [from, to] : edges)
        if (!edges.contains({to, from})) hull.push_back({from, to, p});
}

} // namespace

bool has_volume(const TetraCorners& corners) {
    if (certain_orientation(corners) != 0) return true;
    if (const auto lattice = small_lattice(corners, corners)) return orientation(lattice->a) != 0;
    return orientation(big_lattice(corners, corners).a) != 0;
}

double hull_volume(std::span<const std::array<double, 3>> given) {
    const auto [points, exponent] = lattice_points(given);
    auto hull = first_hull(points);
    if (hull.empty()) return 0;
    for (std::size_t p = 0; p < points.size(); ++p) add_point(hull, points, p);
    mpz_class sum = 0;
    for (const auto& t : hull) sum += signed_volume(points, t, points.front());
    mpq_class volume(sum, 6);
    volume.canonicalize();
    return nearest(scaled(volume, 3 * exponent));
}

} // namespace tandem
