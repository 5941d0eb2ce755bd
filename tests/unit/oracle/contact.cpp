// SPDX-License-Identifier: MIT
#include "geometry/contact_truth.h"
#include "geometry/exact_contact.h"
#include "geometry/rounding.h"
#include "tests/support/oracle_pairs.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

TEST(OracleContact, ACornerInside) {
    const auto truth = contact_truth(unit, moved(unit, 0.25, 0.25, 0.25));
    ASSERT_TRUE(truth);
    EXPECT_EQ(truth->relation, Relation::overlapping);
    EXPECT_THAT(truth->vertices,
                testing::ElementsAre(std::array{0.25, 0.25, 0.25}, std::array{0.25, 0.25, 0.5},
                                     std::array{0.25, 0.5, 0.25}, std::array{0.5, 0.25, 0.25}));
    EXPECT_EQ(truth->volume, 1.0 / 384);
    EXPECT_EQ(truth->depth_squared, 1.0 / 48);
    EXPECT_EQ(truth->depth, std::sqrt(1.0 / 48));
    const double third = geometry::nearest_root(mpq_class(1, 3));
    for (const auto& normal : truth->normals) EXPECT_EQ(normal, (std::array{third, third, third}));
    EXPECT_GE(truth->normals.size(), 1u);
}

TEST(OracleContact, Identical) {
    const auto truth = contact_truth(unit, unit);
    ASSERT_TRUE(truth);
    EXPECT_EQ(truth->vertices.size(), 4u);
    EXPECT_EQ(truth->volume, 1.0 / 6);
    EXPECT_EQ(truth->depth_squared, 1.0 / 3); // its minimal width, between a corner and the opposite face
    const double third = geometry::nearest_root(mpq_class(1, 3));
    EXPECT_THAT(truth->normals, testing::UnorderedElementsAre(std::array{third, third, third},
                                                              std::array{-third, -third, -third}));
}

/// Two regular tetrahedra in one cube: their intersection is a regular octahedron.
TEST(OracleContact, Octahedron) {
    const TetraCorners a{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};
    auto b = a;
    for (auto& corner : b)
        for (auto& x : corner) x = -x;
    const auto truth = contact_truth(a, b);
    ASSERT_TRUE(truth);
    EXPECT_EQ(truth->vertices.size(), 6u);
    EXPECT_EQ(truth->volume, 4.0 / 3);
}

TEST(OracleContact, TouchingHasNoVolumeAndNoDepth) {
    const TetraCorners below{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}}};
    const auto truth = contact_truth(unit, below);
    ASSERT_TRUE(truth);
    EXPECT_EQ(truth->relation, Relation::touching);
    EXPECT_EQ(truth->vertices.size(), 3u);
    EXPECT_EQ(truth->volume, 0);
    EXPECT_EQ(truth->depth, 0);
    for (const auto& normal : truth->normals) EXPECT_EQ(normal, (std::array{0.0, 0.0, -1.0}));
    EXPECT_EQ(contact_truth(unit, moved(unit, 1, 0, 0))->vertices.size(), 1u);
}

TEST(OracleContact, DisjointPairsHaveNoContact) {
    const auto truth = contact_truth(unit, moved(unit, 0.5, 0.5, 0.5));
    ASSERT_TRUE(truth);
    EXPECT_EQ(truth->relation, Relation::disjoint);
    EXPECT_TRUE(truth->vertices.empty());
    EXPECT_FALSE(contact_truth(unit, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}})) << "flat";
    auto spoiled = unit;
    spoiled[2][1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(contact_truth(unit, spoiled));
}

TEST(OracleContact, TheIntersectionOfNestedPairsIsTheInnerOne) {
    TouchMaker make(1);
    for (int round = 0; round < 100; ++round) {
        const auto [a, b] = make.nested();
        const auto exact = geometry::exact_contact(a, b, 0);
        ASSERT_TRUE(exact);
        EXPECT_EQ(exact->vertices.size(), 4u);
        EXPECT_EQ(exact->volume * 6, mpq_class(std::abs(TouchMaker::determinant(b))));
    }
}

/// One of the pair is cut in two at the middle of an edge: the volumes of the parts add up exactly.
TEST(OracleContact, VolumesAddUp) {
    Random random(2);
    unsigned overlapping = 0;
    for (int round = 0; round < 300; ++round) {
        const auto family = round % 3 == 0   ? Family::sliver
                            : round % 3 == 1 ? Family::near_touch
                                             : Family::generic;
        const auto [a, b] = random_pair(family, random);
        auto first = a, second = a;
        for (unsigned k = 0; k < 3; ++k) first[0][k] = second[1][k] = (a[0][k] + a[1][k]) / 2;
        const auto whole = geometry::exact_contact(a, b, 0);
        const auto p = geometry::exact_contact(first, b, 0), q = geometry::exact_contact(second, b, 0);
        if (!whole || !p || !q) continue;
        overlapping += whole->relation == Relation::overlapping;
        EXPECT_EQ(p->volume + q->volume, whole->volume);
        EXPECT_EQ(whole->volume > 0, whole->relation == Relation::overlapping);
        EXPECT_EQ(whole->vertices.empty(), whole->relation == Relation::disjoint);
    }
    EXPECT_GT(overlapping, 50u);
}

/// Slightly less than the translation leaves an overlap, slightly more separates, and no shorter translation
/// does.
TEST(OracleContact, TranslationsSeparate) {
    Random random(3);
    for (int round = 0; round < 300; ++round) {
        const auto [a, b] = random_pair(Family::generic, random);
        const auto truth = contact_truth(a, b);
        const auto back = contact_truth(b, a);
        ASSERT_TRUE(truth && back);
        EXPECT_EQ(truth->depth_squared, back->depth_squared);
        EXPECT_EQ(truth->volume, back->volume);
        if (truth->relation != Relation::overlapping) continue;
        const auto push = [&, b = b](const std::array<double, 3>& n, double by) {
            return moved(b, by * n[0], by * n[1], by * n[2]);
        };
        for (const auto& normal : truth->normals) {
            EXPECT_EQ(relation(a, push(normal, truth->depth * (1 + 1e-5) + 1e-12)), Relation::disjoint);
            EXPECT_EQ(relation(a, push(normal, truth->depth * (1 - 1e-5))), Relation::overlapping);
        }
        for (int i = 0; i < 20; ++i) {
            const auto d = random.direction();
            EXPECT_EQ(relation(a, push({d.x(), d.y(), d.z()}, truth->depth * (1 - 1e-9))),
                      Relation::overlapping);
        }
    }
}

TEST(OracleContact, PowersOfTwoScaleEverything) {
    Random random(4);
    for (int round = 0; round < 50; ++round) {
        const auto pair = random_pair(Family::generic, random);
        const auto large = changed(pair, [](double x) { return std::ldexp(x, 100); });
        const auto truth = contact_truth(pair.a, pair.b), scaled = contact_truth(large.a, large.b);
        ASSERT_TRUE(truth && scaled);
        EXPECT_EQ(std::ldexp(truth->volume, 300), scaled->volume);
        EXPECT_EQ(std::ldexp(truth->depth, 100), scaled->depth);
        EXPECT_EQ(truth->normals, scaled->normals);
    }
}

/// A single operation of the processor also rounds once, whatever its result.
TEST(OracleRounding, AsTheProcessorRounds) {
    Random random(5);
    for (int round = 0; round < 20000; ++round) {
        const auto number = [&] {
            const auto exponent = static_cast<int>(random.uniform(-600, 500));
            return std::ldexp(random.uniform(-1, 1), exponent);
        };
        const double x = number(), y = number(); // zero has a chance of 2^-53
        const mpq_class p(x), q(y);
        ASSERT_EQ(geometry::nearest(p * q), x * y) << x << ' ' << y;
        ASSERT_EQ(geometry::nearest(p / q), x / y) << x << ' ' << y;
        ASSERT_EQ(geometry::nearest(p), x);
        ASSERT_EQ(geometry::nearest_root(abs(p)), std::sqrt(std::fabs(x))) << x;
    }
    EXPECT_EQ(geometry::nearest(0), 0);
    EXPECT_EQ(geometry::nearest_root(0), 0);
    EXPECT_EQ(geometry::nearest(mpq_class(1, 1) << 2000), std::numeric_limits<double>::infinity());
}

} // namespace
} // namespace tandem
