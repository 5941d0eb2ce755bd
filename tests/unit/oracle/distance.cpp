// SPDX-License-Identifier: MIT
// exact_distance() of known pairs, and beside the same features in long double.
#include "tests/support/distances.h"
#include "tests/support/test.h"

#include "base/random.h"
#include "geometry/exact_distance.h"

namespace tandem::unit_test {
namespace {

constexpr TetraCorners unit{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

TetraCorners moved(TetraCorners corners, const std::array<double, 3>& by) {
    for (auto& corner : corners)
        for (unsigned k = 0; k < 3; ++k) corner[k] += by[k];
    return corners;
}

TEST(ExactDistance, KnownPairs) {
    EXPECT_EQ(exact_distance(unit, moved(unit, {1.25, 0, 0})), 0.25);
    EXPECT_EQ(exact_distance(unit, moved(unit, {2, 2, 0})), std::sqrt(3 * 3 / 2.0)) << "an edge and a corner";
    EXPECT_EQ(exact_distance(unit, moved(unit, {1, 1, 1})), std::sqrt(4 / 3.0)) << "a face and a corner";
    EXPECT_EQ(exact_distance(unit, moved(unit, {1 + 0x1p-52, 0, 0})), 0x1p-52)
        << "no rounding before the last";
    EXPECT_FALSE(exact_distance(unit, moved(unit, {1, 0, 0})).has_value()) << "they touch";
    EXPECT_FALSE(exact_distance(unit, unit).has_value());
    EXPECT_FALSE(exact_distance(unit, moved(unit, {std::nan(""), 0, 0})).has_value());
    const TetraCorners flat{{{2, 0, 0}, {2, 1, 0}, {2, 0, 1}, {2, 1, 1}}};
    EXPECT_EQ(exact_distance(unit, flat), 1) << "a tetrahedron without volume";
}

TEST(ExactDistance, RandomPairsAreThoseOfLongDouble) {
    Random random(4);
    std::size_t apart = 0;
    for (int i = 0; i < 500; ++i) {
        TetraCorners a, b;
        support::FourCornersOf<long double> p, q;
        for (unsigned corner = 0; corner < 4; ++corner)
            for (unsigned k = 0; k < 3; ++k) {
                a[corner][k] = random.uniform(-1, 1);
                b[corner][k] = random.uniform(-1, 1) + (k == 0 ? 1.2 : 0);
                p[corner][k] = a[corner][k];
                q[corner][k] = b[corner][k];
            }
        const auto exact = exact_distance(a, b);
        if (!exact) continue;
        ++apart;
        EXPECT_NEAR(*exact, static_cast<double>(support::distance_between(p, q)), 1e-15);
    }
    EXPECT_GT(apart, 100u);
}

} // namespace
} // namespace tandem::unit_test
