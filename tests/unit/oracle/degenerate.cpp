// SPDX-License-Identifier: MIT
// Tetrahedra without volume: every intersection counts as touching.
#include "geometry/lattice.h"
#include "geometry/program.h"
#include "tests/support/oracle_pairs.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

TetraCorners point(double x, double y, double z) { return {{{x, y, z}, {x, y, z}, {x, y, z}, {x, y, z}}}; }

TetraCorners segment(std::array<double, 3> p, std::array<double, 3> q) { return {{p, p, q, q}}; }

/// A square in the plane of height z, with its corner at (x, y).
TetraCorners square(double x, double y, double z) {
    return {{{x, y, z}, {x + 1, y + 1, z}, {x + 1, y, z}, {x, y + 1, z}}};
}

void expect(const TetraCorners& a, const TetraCorners& b, Relation relation, const char* name) {
    for (const auto first : {Tier::screen, Tier::filter, Tier::integers, Tier::big_integers}) {
        EXPECT_EQ(decide(a, b, first).relation, relation) << name;
        EXPECT_EQ(decide(b, a, first).relation, relation) << name << ", swapped";
    }
}

TEST(OracleDegenerate, Points) {
    expect(unit, point(0.125, 0.125, 0.125), Relation::touching, "inside");
    expect(unit, point(0.5, 0.5, 0), Relation::touching, "on an edge");
    expect(unit, point(0, 0, 1), Relation::touching, "on a corner");
    expect(unit, point(0.5, 0.5, 0x1p-60), Relation::disjoint, "just off an edge");
    expect(point(1, 2, 3), point(1, 2, 3), Relation::touching, "the same point");
    expect(point(1, 2, 3), point(1, 2, std::nextafter(3.0, 4.0)), Relation::disjoint, "neighbouring points");
}

TEST(OracleDegenerate, Segments) {
    expect(unit, segment({-1, 0.25, 0.25}, {2, 0.25, 0.25}), Relation::touching, "through");
    expect(unit, segment({-1, 0.75, 0.75}, {2, 0.75, 0.75}), Relation::disjoint, "past, boxes meeting");
    expect(unit, segment({-1, 0, 0}, {0, 0, 0}), Relation::touching, "up to a corner");
    expect(segment({0, 0, 0}, {2, 2, 2}), segment({2, 0, 0}, {0, 2, 2}), Relation::touching, "crossing");
    expect(segment({0, 0, 0}, {2, 2, 2}), segment({2, 0, 0x1p-50}, {0, 2, 2}), Relation::disjoint, "skew");
    expect(segment({0, 0, 0}, {3, 3, 3}), segment({1, 1, 1}, {5, 5, 5}), Relation::touching,
           "along each other");
    expect(segment({0, 0, 0}, {3, 3, 3}), segment({4, 4, 4}, {5, 5, 5}), Relation::disjoint, "on one line");
}

TEST(OracleDegenerate, Flat) {
    expect(unit, square(-0.25, -0.25, 0.5), Relation::touching, "across");
    expect(unit, square(0.3, 0.3, 0.5), Relation::disjoint, "beside, boxes meeting");
    expect(square(0, 0, 0), square(0.5, 0.5, 0), Relation::touching, "overlapping in one plane");
    expect(square(0, 0, 0), square(1, 1, 0), Relation::touching, "corner on corner in one plane");
    const TetraCorners diamond{{{1.5, 1, 0}, {1, 1.5, 0}, {1.5, 2, 0}, {2, 1.5, 0}}};
    expect(square(0, 0, 0), diamond, Relation::disjoint, "in one plane, boxes meeting, no axis out of it");
    expect(square(0, 0, 0), square(0, 0, 0x1p-70), Relation::disjoint, "one just above the other");
}

/// A face of a tetrahedron intersects no more than the tetrahedron does; one of the faces contains the
/// contact.
TEST(OracleDegenerate, FacesOfConstructedPairs) {
    TouchMaker make(1);
    for (int round = 0; round < 100; ++round) {
        const auto touching = make.touching(1 + round % 3, 3, 1 << 17);
        const auto apart = make.one_ulp(1);
        unsigned holding = 0;
        for (unsigned i = 0; i < 4; ++i) {
            auto face = touching.a;
            face[i] = face[(i + 1) % 4];
            holding += relation(face, touching.b) == Relation::touching;
            auto away = apart.a;
            away[i] = away[(i + 1) % 4];
            expect(away, apart.b, Relation::disjoint, "a face of one that is apart");
        }
        EXPECT_GE(holding, 1u);
    }
}

/// The linear program uses no facets and needs no volume: an independent answer for all pairs.
TEST(OracleDegenerate, ProgramAgreesWithFacets) {
    Random random(2);
    TouchMaker make(2);
    const auto same = [](const OraclePair& pair) {
        const auto lattice = geometry::big_lattice(pair.a, pair.b);
        return geometry::hulls_meet(lattice.a, lattice.b) == (relation(pair.a, pair.b) != Relation::disjoint);
    };
    for (unsigned family = 0; family < static_cast<unsigned>(Family::count); ++family)
        for (int i = 0; i < 200; ++i) ASSERT_TRUE(same(random_pair(static_cast<Family>(family), random)));
    for (int i = 0; i < 200; ++i) {
        ASSERT_TRUE(same(make.touching(1 + i % 3, 1 + i / 3 % 3, 1 << 17)));
        ASSERT_TRUE(same(make.one_ulp(1)));
        ASSERT_TRUE(same(make.one_ulp(-1)));
    }
}

} // namespace
} // namespace tandem
