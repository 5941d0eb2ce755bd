// SPDX-License-Identifier: MIT
#include "harness/oracle/posed.h"

#include "harness/oracle/program.h"

namespace tandem::oracle {

namespace {

/// Both in units of 1 / the least common multiple of all denominators.
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

} // namespace

Vector<mpq_class> posed_point(const Pose& pose, const Vector<double>& point) {
    const mpq_class w(pose.rotation.w()), x(pose.rotation.x()), y(pose.rotation.y()), z(pose.rotation.z());
    const Vector<mpq_class> p{mpq_class(point[0]), mpq_class(point[1]), mpq_class(point[2])};
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

Relation relation(const Points<mpq_class>& a, const Points<mpq_class>& b) {
    const auto [p, q] = on_lattice(a, b);
    if (orientation(p) == 0 || orientation(q) == 0)
        return hulls_meet(p, q) ? Relation::touching : Relation::disjoint;
    auto found = Relation::overlapping;
    for_each_facet(p, q, all_facets, [&](const Facet<mpz_class>& facet) {
        if (facet.gap == 0) found = Relation::touching;
        if (facet.gap > 0) found = Relation::disjoint;
        return found != Relation::disjoint;
    });
    return found;
}

} // namespace tandem::oracle
