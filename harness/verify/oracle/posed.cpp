// SPDX-License-Identifier: MIT
#include "harness/verify/oracle/posed.h"

#include "geometry/filter.h"
#include "geometry/program.h"

#include <algorithm>

namespace tandem::oracle {

namespace {

/// Scales both to integers by the least common multiple of all denominators.
std::array<Points<mpz_class>, 2> on_lattice(const Points<mpq_class>& a, const Points<mpq_class>& b) {
    mpz_class unit = 1;
    for (const auto* points : {&a, &b})
        for (const auto& point : *points)
            for (const auto& x : point) unit = lcm(unit, x.get_den());
    std::array<Points<mpz_class>, 2> result;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned axis = 0; axis < 3; ++axis) {
            result[0][i][axis] = a[i][axis].get_num() * (unit / a[i][axis].get_den());
            result[1][i][axis] = b[i][axis].get_num() * (unit / b[i][axis].get_den());
        }
    return result;
}

/// Every double is a rational, so that nothing is rounded.
Points<mpq_class> exactly(const Posed& posed) {
    if (posed.pose != nullptr) return posed_corners(*posed.pose, posed.own);
    Points<mpq_class> result;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned axis = 0; axis < 3; ++axis) result[i][axis] = mpq_class(posed.own[i][axis]);
    return result;
}

} // namespace

Vector<mpq_class> posed_point(const Pose& pose, const Vector<double>& point) {
    const mpq_class w(pose.rotation.w()), x(pose.rotation.x()), y(pose.rotation.y()), z(pose.rotation.z());
    const Vector<mpq_class> p{mpq_class(point[0]), mpq_class(point[1]), mpq_class(point[2])};
    // M(q) / (q . q): one division avoids the irrational square root that normalises q.
    const mpq_class square = w * w + x * x + y * y + z * z;
    const Vector<mpq_class> rows[3]{
        {w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
        {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
        {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
    Vector<mpq_class> result;
    for (unsigned i = 0; i < 3; ++i) result[i] = dot(rows[i], p) / square + mpq_class(pose.translation[i]);
    return result;
}

Points<mpq_class> posed_corners(const Pose& pose, const TetraCorners& corners) {
    Points<mpq_class> result;
    for (unsigned i = 0; i < 4; ++i) result[i] = posed_point(pose, corners[i]);
    return result;
}

Decision decide(const Points<mpq_class>& a, const Points<mpq_class>& b, FacetSet unsure) {
    const auto [p, q] = on_lattice(a, b);
    // The facets of the difference need two solids. For flat tetrahedra solve a linear program.
    if (orientation(p) == 0 || orientation(q) == 0)
        return {hulls_meet(p, q) ? Relation::touching : Relation::disjoint, Tier::program};
    auto found = Relation::overlapping;
    for_each_facet(p, q, unsure, [&](const Facet<mpz_class>& facet) {
        if (facet.gap == 0) found = Relation::touching;
        if (facet.gap > 0) found = Relation::disjoint;
        return found != Relation::disjoint;
    });
    return {found, Tier::big_integers};
}

Decision decide(const Posed& a, const Posed& b) {
    if (!all_finite(a.near) || !all_finite(b.near)) return {Relation::invalid, Tier::screen};
    const auto filtered = filter(a.near, b.near, std::max(a.off, b.off));
    if (filtered.disjoint) return {Relation::disjoint, Tier::filter};
    // All facets are certain and both tetrahedra have a volume: the origin is inside all facets.
    if (filtered.unsure == 0 && filtered.volume[0] && filtered.volume[1])
        return {Relation::overlapping, Tier::filter};
    return decide(exactly(a), exactly(b), filtered.unsure);
}

} // namespace tandem::oracle
