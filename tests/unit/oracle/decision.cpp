// SPDX-License-Identifier: MIT
// The exact decision on pairs whose answer is known by construction, starting at every tier.
#include "geometry/decision.h"
#include "tests/support/oracle_pairs.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

/// Expects the same answer from every starting tier, for both orders of the pair.
void expect(const OraclePair& pair, Relation relation, const char* name) {
    for (const auto first : {Tier::screen, Tier::filter, Tier::integers, Tier::big_integers}) {
        EXPECT_EQ(decide(pair.a, pair.b, first).relation, relation)
            << name << ", from tier " << static_cast<int>(first);
        EXPECT_EQ(decide(pair.b, pair.a, first).relation, relation)
            << name << " swapped, from tier " << static_cast<int>(first);
    }
}

TEST(OracleDecision, HandMade) {
    expect({unit, unit}, Relation::overlapping, "identical");
    expect({unit, moved(unit, 2, 0, 0)}, Relation::disjoint, "boxes apart");
    expect({unit, moved(unit, 0.5, 0.5, 0.5)}, Relation::disjoint, "boxes meet, face between");
    expect({unit, moved(unit, 1, 0, 0)}, Relation::touching, "corner on corner");
    expect({unit, moved(unit, 0.5, 0.5, 0)}, Relation::touching, "corner on edge");
    expect({unit, moved(unit, 0.25, 0.25, 0.5)}, Relation::touching, "corner on face");
    expect({unit, moved(unit, 0.25, 0.25, 0.25)}, Relation::overlapping, "corner inside");
    const TetraCorners below{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}}};
    expect({unit, below}, Relation::touching, "a common face");
    expect({unit, moved(below, 5, 0, 0)}, Relation::disjoint, "faces in one plane");
    const TetraCorners across{{{0, 0, 0}, {0, 0, -1}, {1, 0, -1}, {1, 1, 0}}};
    expect({unit, across}, Relation::touching, "a common edge's end and a crossing");
    // Edges that cross at their middles in skew tetrahedra: no face separates these.
    const TetraCorners low{{{-1, 0, 0}, {1, 0, 0}, {0, -1, -9}, {0, 1, -9}}};
    const TetraCorners high{{{0, -1, 0}, {0, 1, 0}, {-1, 0, 9}, {1, 0, 9}}};
    expect({low, high}, Relation::touching, "edge on edge");
    expect({low, moved(high, 0, 0, 0x1p-40)}, Relation::disjoint, "edges a little apart");
    expect({low, moved(high, 0, 0, -0x1p-40)}, Relation::overlapping, "edges a little through");
}

TEST(OracleDecision, NonFiniteCorners) {
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
          -std::numeric_limits<double>::infinity()})
        for (unsigned i = 0; i < 4; ++i)
            for (unsigned axis = 0; axis < 3; ++axis) {
                auto spoiled = moved(unit, 9, 9, 9);
                spoiled[i][axis] = bad;
                expect({unit, spoiled}, Relation::invalid, "not finite");
            }
}

TEST(OracleDecision, TouchingByConstruction) {
    TouchMaker make(1);
    for (int round = 0; round < 200; ++round)
        for (unsigned of_a = 1; of_a <= 3; ++of_a)
            for (unsigned of_b = 1; of_b <= 3; ++of_b)
                for (const int largest : {1, 40, 1 << 17}) {
                    const auto pair = make.touching(of_a, of_b, largest);
                    ASSERT_TRUE(all_floats(pair));
                    expect(pair, Relation::touching, "in one plane");
                    ASSERT_FALSE(HasFailure()) << of_a << ' ' << of_b << ' ' << largest;
                }
}

TEST(OracleDecision, OneUnitInTheLastPlace) {
    TouchMaker make(2);
    for (int round = 0; round < 2000; ++round) {
        const auto apart = make.one_ulp(1), through = make.one_ulp(-1);
        ASSERT_TRUE(all_floats(apart) && all_floats(through));
        expect(apart, Relation::disjoint, "one unit apart");
        expect(through, Relation::overlapping, "one unit through");
        ASSERT_FALSE(HasFailure()) << round;
    }
}

TEST(OracleDecision, Nested) {
    TouchMaker make(3);
    for (int round = 0; round < 1000; ++round) expect(make.nested(), Relation::overlapping, "nested");
}

TEST(OracleDecision, FarFromTheOrigin) {
    TouchMaker make(4);
    for (int round = 0; round < 500; ++round) {
        const auto pair = make.touching(1 + round % 3, 3, 10);
        const auto far = changed(pair, [](double x) { return x / 16 + 1e6; });
        ASSERT_TRUE(all_floats(far));
        expect(far, Relation::touching, "at a million");
    }
}

TEST(OracleDecision, PowersOfTwoChangeNothing) {
    TouchMaker make(5);
    Random random(5);
    for (int round = 0; round < 300; ++round) {
        const auto touching = make.touching(1 + round % 3, 1 + round / 3 % 3, 1 << 17);
        const auto apart = make.one_ulp(1), through = make.one_ulp(-1);
        // From numbers without a spare bit above zero up to the largest ones.
        for (const int exponent : {-1074, -1050, -700, -149, -126, 100, 300, 700, 999}) {
            const auto scale = [&](double x) { return std::ldexp(x, exponent); };
            expect(changed(touching, scale), Relation::touching, "scaled");
            expect(changed(apart, scale), Relation::disjoint, "scaled, apart");
            expect(changed(through, scale), Relation::overlapping, "scaled, through");
            ASSERT_FALSE(HasFailure()) << exponent;
        }
    }
}

TEST(OracleDecision, OrderOfCornersChangesNothing) {
    Random random(6);
    TouchMaker make(6);
    for (int family = 0; family < static_cast<int>(Family::count); ++family)
        for (int round = 0; round < 2000; ++round) {
            const auto pair = random_pair(static_cast<Family>(family), random);
            ASSERT_TRUE(all_floats(pair));
            const auto other = make.shuffled(pair);
            ASSERT_EQ(relation(pair.a, pair.b), relation(other.a, other.b));
            ASSERT_EQ(relation(pair.a, pair.b), relation(other.b, other.a));
        }
}

/// Spans the whole range of double: a corner of one at its end, the smallest component of the other at
/// 2^-1074.
TEST(OracleDecision, TheWholeRange) {
    constexpr double most = std::numeric_limits<double>::max();
    constexpr double least = std::numeric_limits<double>::denorm_min();
    const TetraCorners large{{{-most, -most, 0}, {most, -most, 0}, {0, most, 0}, {0, 0, -most}}};
    const TetraCorners small{{{0, 0, 0}, {least, 0, 0}, {0, least, 0}, {0, 0, least}}};
    expect({large, small}, Relation::touching, "a small one on a large one");
    expect({large, moved(small, 0, 0, least)}, Relation::disjoint, "above it");
    expect({large, moved(small, 0, 0, -least)}, Relation::overlapping, "through it");
}

} // namespace
} // namespace tandem
