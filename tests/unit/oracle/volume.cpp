// SPDX-License-Identifier: MIT
// Whether a tetrahedron has volume, and the volume of a hull of points.
#include "geometry/contact_truth.h"
#include "geometry/filter.h"
#include "geometry/lattice.h"
#include "geometry/volume.h"
#include "tests/support/oracle_pairs.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using Point = std::array<double, 3>;

TetraCorners with_apex(const Point& apex) { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, apex}}; }

TEST(OracleVolume, TheLeastHeightIsOne) {
    constexpr double least = std::numeric_limits<double>::denorm_min();
    EXPECT_TRUE(has_volume(unit));
    EXPECT_FALSE(has_volume(with_apex({0.3, 0.4, 0})));
    for (const double height : {least, -least, 0x1p-60, -0x1p-60, 1e300})
        EXPECT_TRUE(has_volume(with_apex({0.3, 0.4, height}))) << height;
    EXPECT_FALSE(has_volume({{{1, 2, 3}, {1, 2, 3}, {4, 5, 7}, {0, 0, 1}}})) << "two equal corners";
    EXPECT_FALSE(has_volume({{{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {5, 5, 5}}})) << "on a line";
    EXPECT_FALSE(has_volume({{{least, 0, 0}, {0, least, 0}, {least, least, 0}, {0, 0, 0}}}));
    EXPECT_TRUE(has_volume({{{least, 0, 0}, {0, least, 0}, {0, 0, least}, {0, 0, 0}}}));
}

TEST(OracleVolume, DifferencesMayOverflow) {
    constexpr double big = 1.5e308;
    EXPECT_TRUE(has_volume({{{-big, -big, -big}, {big, -big, -big}, {-big, big, -big}, {-big, -big, big}}}));
    EXPECT_FALSE(has_volume({{{-big, -big, 1}, {big, -big, 1}, {-big, big, 1}, {big, big, 1}}}));
}

/// x + y + z = 1 + h: a slanted plane on the lattice of 2^-20, for which doubles are not certain of the sign.
TEST(OracleVolume, SlantedPlanesAreDecidedByIntegers) {
    Random random(3);
    const auto on_plane = [&](double lift) -> Point {
        const double x = std::floor(random.uniform() * 0x1p20) * 0x1p-20;
        const double y = std::floor(random.uniform() * 0x1p20) * 0x1p-20;
        return {x, y, 1 + lift - x - y};
    };
    int unsure = 0;
    for (int i = 0; i < 2000; ++i) {
        const double lift = i % 2 == 0 ? 0 : 0x1p-50;
        const TetraCorners corners{on_plane(0), on_plane(0), on_plane(0), on_plane(lift)};
        unsure += geometry::certain_orientation(corners) == 0 ? 1 : 0;
        const bool in_plane = geometry::orientation(geometry::big_lattice(corners, corners).a) == 0;
        EXPECT_EQ(in_plane, lift == 0) << i; // three random points are not collinear
        EXPECT_EQ(has_volume(corners), !in_plane) << i;
    }
    EXPECT_GE(unsure, 1000);
}

std::vector<Point> cube() {
    std::vector<Point> points;
    for (int i = 0; i < 8; ++i)
        points.push_back(
            {static_cast<double>(i & 1), static_cast<double>(i >> 1 & 1), static_cast<double>(i >> 2)});
    return points;
}

void shuffle(std::vector<Point>& points, Random& random) {
    for (auto i = points.size(); i > 1; --i) std::swap(points[i - 1], points[random.next() % i]);
}

TEST(HullVolume, OfSolidsWithPointsInAllPositions) {
    EXPECT_EQ(hull_volume(unit), 1.0 / 6);
    EXPECT_EQ(hull_volume(cube()), 1);
    auto points = cube();
    for (const double x : {0.0, 0.25, 0.5, 1.0}) // on corners, edges and faces, and inside
        for (const double y : {0.0, 0.5, 1.0})
            for (const double z : {0.0, 0.75, 1.0}) points.push_back({x, y, z});
    Random random(4);
    for (int i = 0; i < 100; ++i) {
        shuffle(points, random);
        ASSERT_EQ(hull_volume(points), 1) << i;
    }
    points.push_back({0.5, 0.5, 4}); // a pyramid on the upper face
    for (int i = 0; i < 20; ++i) {
        shuffle(points, random);
        ASSERT_EQ(hull_volume(points), 2) << i;
    }
}

TEST(HullVolume, IsZeroForFlatHullsAndExactAtAnySize) {
    EXPECT_EQ(hull_volume({}), 0);
    const std::vector<Point> one(7, {1, 2, 3});
    EXPECT_EQ(hull_volume(one), 0);
    const std::vector<Point> line{{0, 0, 0}, {3, 3, 3}, {1, 1, 1}, {-2, -2, -2}, {0.1, 0.1, 0.1}};
    EXPECT_EQ(hull_volume(line), 0);
    const std::vector<Point> flat{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.3, 0.7, 1}};
    EXPECT_EQ(hull_volume(flat), 0);
    auto sliver = flat;
    sliver.push_back({0.5, 0.5, 1 + 0x1p-52});
    EXPECT_EQ(hull_volume(sliver), 0x1p-52 / 3);
    for (const int exponent : {-340, -30, 30, 300}) {
        auto scaled = cube();
        for (auto& p : scaled)
            for (auto& x : p) x = std::ldexp(x, exponent);
        EXPECT_EQ(hull_volume(scaled), std::ldexp(1.0, 3 * exponent)) << exponent;
    }
}

/// Two independent computations of one volume: from the facets of the two tetrahedra, and from a hull of the
/// intersection's vertices.
TEST(HullVolume, OfTheVerticesOfAnIntersectionIsItsVolume) {
    Random random(11);
    int compared = 0;
    for (int i = 0; i < 400; ++i) {
        const auto pair = random_pair(Family::generic, random);
        const auto truth = contact_truth(pair.a, pair.b);
        if (!truth || truth->relation != Relation::overlapping) continue;
        const double size = std::cbrt(truth->volume);
        if (size < 1e-2) continue; // vertices are rounded to doubles, which matters for slivers
        EXPECT_NEAR(hull_volume(truth->vertices) / truth->volume, 1, 1e-8) << i;
        ++compared;
    }
    EXPECT_GT(compared, 50);
}

} // namespace
} // namespace tandem
