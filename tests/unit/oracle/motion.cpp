// SPDX-License-Identifier: MIT
// Tetrahedra on straight paths: cases known by construction, and random ones against many times.
#include "tests/support/moving_pairs.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

constexpr double far_down = -100;

/// Decides with every tier, in both orders, with shuffled corners, under integer maps and at other scales.
void expect_meeting(const MovingPair& pair, Meeting expected) {
    Random random(7);
    constexpr double maps[][3][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                     {{2, 1, -3}, {1, -1, 5}, {4, 3, 1}},
                                     {{0, 3, 1}, {-2, 7, 5}, {1, 1, 8}}};
    for (const auto& map : maps)
        for (const double scale : {1.0, 0x1p-900, 0x1p800}) {
            auto changed_pair = changed(pair, [&](const std::array<double, 3>& x) {
                std::array<double, 3> y;
                for (unsigned i = 0; i < 3; ++i)
                    y[i] = scale * (map[i][0] * x[0] + map[i][1] * x[1] + map[i][2] * x[2] + 16 * i);
                return y;
            });
            changed_pair = shuffled(changed_pair, random);
            const auto& [a, b] = changed_pair;
            EXPECT_EQ(meet_in_motion(a, b).meeting, expected) << scale;
            EXPECT_EQ(meet_in_motion(b, a).meeting, expected) << scale;
            EXPECT_EQ(meet_in_motion(a, b, MeetingTier::polynomials).meeting, expected) << scale;
            EXPECT_EQ(meet_in_motion(b, a, MeetingTier::polynomials).meeting, expected) << scale;
        }
}

/// In the plane z = 0: corner (2s, c, down) passes the edge from the origin to (2, 2s, 0), where 2 s s = c.
/// The rest of a is above the plane and the rest of b below it, so they meet at that time only.
MovingPair passing_an_edge(double c, double down) {
    const TetraCorners a0{{{0, 0, 0}, {2, 0, 0}, {0, 1, 8}, {1, -1, 8}}};
    const TetraCorners b0{{{0, c, down}, {-1, 0, -8}, {3, 0, -8}, {0, 4, -8}}};
    auto a1 = a0, b1 = b0;
    a1[1] = {2, 2, 0};
    b1[0] = {2, c, down};
    return {straight(a0, a1), straight(b0, b1)};
}

TEST(OracleMotion, InOneInstantAtAnIrrationalTime) {
    expect_meeting(passing_an_edge(1, 0), Meeting::meeting);    // sqrt(1/2)
    expect_meeting(passing_an_edge(0.75, 0), Meeting::meeting); // sqrt(3/8)
    expect_meeting(passing_an_edge(1, -0x1p-40), Meeting::apart);
    expect_meeting(passing_an_edge(2.5, 0), Meeting::apart); // it would pass at s > 1
    EXPECT_FALSE(meets_at_a_step(passing_an_edge(1, 0), 1 << 12));
}

TEST(OracleMotion, InOneInstantAtARationalTime) {
    expect_meeting(passing_an_edge(0.5, 0), Meeting::meeting); // 1/2
    EXPECT_TRUE(meets_at_a_step(passing_an_edge(0.5, 0), 2));
    EXPECT_FALSE(meets_at_a_step(passing_an_edge(0.5, 0), 3));
    // 1/3, in units of 1/9: 2 s s = 2 / 9
    auto pair = changed(passing_an_edge(0.25, 0), [](auto x) {
        return std::array{9 * x[0], 9 * x[1], 9 * x[2]};
    });
    pair.b.from[0][1] = pair.b.to[0][1] = 2;
    expect_meeting(pair, Meeting::meeting);
    EXPECT_TRUE(meets_at_a_step(pair, 3));
    EXPECT_FALSE(meets_at_a_step(pair, 1 << 10));
}

/// The plane z = 4 s x of a's face rises, and b's corner (1 - s, 0, 1 + up) moves to where it is lower. The
/// corner's height over it is (2s - 1)^2 + up.
MovingPair grazing_a_face(double up) {
    const TetraCorners a0{{{0, -2, 0}, {0, 2, 0}, {2, 0, 0}, {1, 0, far_down}}};
    const TetraCorners b0{{{1, 0, 1 + up}, {1, -1, 100}, {1, 1, 100}, {2, 0, 100}}};
    auto a1 = a0, b1 = b0;
    a1[2] = {2, 0, 8};
    b1[0] = {0, 0, 1 + up};
    return {straight(a0, a1), straight(b0, b1)};
}

/// The same height between an edge of a in the plane y = 0 and an edge of b along y.
MovingPair grazing_an_edge(double up) {
    const TetraCorners a0{{{0, 0, 0}, {2, 0, 0}, {1, -1, far_down}, {1, 1, far_down}}};
    const TetraCorners b0{{{1, -3, 1 + up}, {1, 3, 1 + up}, {0, 0, 100}, {2, 0, 100}}};
    auto a1 = a0, b1 = b0;
    a1[1] = {2, 0, 8};
    b1[0] = {0, -3, 1 + up};
    b1[1] = {0, 3, 1 + up};
    return {straight(a0, a1), straight(b0, b1)};
}

TEST(OracleMotion, GrazingWithADoubleRoot) {
    for (const auto make : {grazing_a_face, grazing_an_edge}) {
        expect_meeting(make(0), Meeting::meeting);
        expect_meeting(make(0x1p-40), Meeting::apart);
        expect_meeting(make(-0x1p-40), Meeting::meeting);
        EXPECT_EQ(meet_in_motion(make(0).a, make(0).b).tier, MeetingTier::polynomials);
        EXPECT_TRUE(meets_at_a_step(make(0), 2));
        EXPECT_FALSE(meets_at_a_step(make(0), 1 << 10 | 1));
    }
}

/// Two faces in the plane z = 0, where b's moves from x = -8 to 8 with its lowest corner at y = `low`. Every
/// polynomial of coplanarity is zero at all times.
MovingPair within_a_plane(double low) {
    const TetraCorners a{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 3}}};
    const TetraCorners b{{{0, low, 0}, {-1, low + 1, 0}, {1, low + 1, 0}, {0, low, -3}}};
    return {straight(a, a), straight(moved(b, -8, 0, 0), moved(b, 8, 0, 0))};
}

TEST(OracleMotion, WithinAPlane) {
    expect_meeting(within_a_plane(1), Meeting::meeting);
    expect_meeting(within_a_plane(2), Meeting::meeting); // two corners meet at s = 1/2
    expect_meeting(within_a_plane(2 + 0x1p-40), Meeting::apart);
    EXPECT_TRUE(meets_at_a_step(within_a_plane(2), 2));
    EXPECT_FALSE(meets_at_a_step(within_a_plane(2), 1 << 10 | 1));
}

/// Edges along y pass each other at x = 2s - 1 and x = 0. One body is above them and one below.
MovingPair with_parallel_edges(double down) {
    const TetraCorners a{{{0, 0, 0}, {0, 2, 0}, {-1, 0, 4}, {1, 0, 4}}};
    const TetraCorners b{{{0, 1, down}, {0, 3, down}, {-1, 0, -4}, {1, 0, -4}}};
    return {straight(a, a), straight(moved(b, -1, 0, 0), moved(b, 1, 0, 0))};
}

TEST(OracleMotion, ParallelEdges) {
    expect_meeting(with_parallel_edges(0), Meeting::meeting);
    expect_meeting(with_parallel_edges(-0x1p-40), Meeting::apart);
    auto beyond = with_parallel_edges(0); // beyond the end of the other edge
    for (auto* corners : {&beyond.b.from, &beyond.b.to})
        for (auto& corner : *corners) corner[1] += 1 + 0x1p-40;
    expect_meeting(beyond, Meeting::apart);
}

TEST(OracleMotion, PassingThroughBetweenTheEnds) {
    const TetraCorners sheet{{{-8, -8, 0}, {8, -8, 0}, {0, 8, 0}, {0, 0, 0x1p-20}}};
    const MovingPair pair{straight(sheet, sheet), straight(moved(unit, 0, 0, 90), moved(unit, 0, 0, -71))};
    expect_meeting(pair, Meeting::meeting);
    const MovingPair beside{straight(sheet, sheet),
                            straight(moved(unit, 0, 8.0625, 90), moved(unit, 0, 8.0625, -71))};
    expect_meeting(beside, Meeting::apart);
}

/// b moves exactly as a does, from 0 to a long way off, and so do both with one unit of relative motion.
TEST(OracleMotion, EqualMotion) {
    const auto touching = moved(unit, 1, 0, 0);
    const auto with = [](const TetraCorners& b, double further) {
        return MovingPair{straight(unit, moved(unit, 512, 256, 64)),
                          straight(b, moved(b, 512 - further, 256, 64))};
    };
    expect_meeting(with(touching, 0), Meeting::meeting);
    expect_meeting(with(moved(touching, 0x1p-30, 0, 0), 0), Meeting::apart);
    expect_meeting(with(moved(touching, 0x1p-30, 0, 0), 0x1p-30), Meeting::meeting);
    expect_meeting(with(moved(touching, 0x1p-30, 0, 0), 0x1p-31), Meeting::apart);
}

/// Without volume at some or all times: hulls of corners on a line, of one point, and an element that inverts
/// while its flat state touches a corner.
TEST(OracleMotion, WithoutVolume) {
    const TetraCorners line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}};
    const TetraCorners point{{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
    const auto passing = [](const TetraCorners& a, const TetraCorners& b, double by_y) {
        return MovingPair{straight(a, a), straight(moved(b, -9, by_y, 0), moved(b, 9, by_y, 0))};
    };
    expect_meeting(passing(line, line, 0), Meeting::meeting);
    expect_meeting(passing(line, point, 0), Meeting::meeting);
    expect_meeting(passing(point, point, 0), Meeting::meeting);
    expect_meeting(passing(point, line, 0), Meeting::meeting);
    expect_meeting(passing(line, line, 1), Meeting::apart);
    expect_meeting(passing(point, point, 1), Meeting::apart);
    // On one line in one instant only: a corner on an edge, away from the edge's corners.
    auto above_line = line;
    for (auto& corner : above_line) corner = {0.25 + 0.125 * corner[0], 0, 4};
    expect_meeting({straight(line, line), straight(moved(above_line, 0, 0, -8), above_line)},
                   Meeting::meeting);
    // In one plane at all times, where only their conditions change.
    const TetraCorners flat{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1, 1, 0}}};
    expect_meeting(passing(flat, flat, 1), Meeting::meeting);
    expect_meeting(passing(flat, flat, 2), Meeting::meeting);
    expect_meeting(passing(flat, flat, 2 + 0x1p-40), Meeting::apart);
    auto inverting = unit;
    inverting[3][2] = -1;
    const auto above = moved(unit, 0.25, 0.25, 1 + 0x1p-30), below = moved(unit, 0.25, 0.25, -2);
    expect_meeting({straight(unit, inverting), straight(above, above)}, Meeting::apart);
    expect_meeting({straight(unit, inverting), straight(below, above)}, Meeting::meeting);
    // Crosses the triangle z = 0 where the element is flat, at s = 1/2, and is outside it before and after.
    auto low = point, high = point;
    for (auto& corner : low) corner = {0.25, 0.25, -4};
    for (auto& corner : high) corner = {0.25, 0.25, 4};
    expect_meeting({straight(unit, inverting), straight(low, high)}, Meeting::meeting);
}

/// Random integers: a common point at one of many times implies a meeting. Most meetings last long enough to
/// be found so.
TEST(OracleMotion, RandomPairsAgreeWithManyTimes) {
    Random random(11);
    std::array<unsigned, 2> counts{};
    unsigned only_exact = 0;
    for (int round = 0; round < 300; ++round) {
        MovingPair pair;
        const int shift = static_cast<int>(random.next() % 48);
        for (auto* corners : {&pair.a.from, &pair.a.to, &pair.b.from, &pair.b.to})
            for (auto& corner : *corners)
                for (auto& x : corner) x = static_cast<int>(random.next() % 33);
        for (auto& corner : pair.b.from) corner[0] += shift;
        for (auto& corner : pair.b.to) corner[1] += shift;
        const auto exact = meet_in_motion(pair.a, pair.b, MeetingTier::polynomials).meeting;
        ASSERT_EQ(meet_in_motion(pair.a, pair.b).meeting, exact) << round;
        ASSERT_EQ(meet_in_motion(pair.b, pair.a, MeetingTier::polynomials).meeting, exact) << round;
        const bool sampled = meets_at_a_step(pair, 64);
        if (sampled) {
            ASSERT_EQ(exact, Meeting::meeting) << round;
        }
        only_exact += exact == Meeting::meeting && !sampled;
        ++counts[exact == Meeting::meeting];
    }
    EXPECT_GT(counts[0], 100u);
    EXPECT_GT(counts[1], 100u);
    EXPECT_LT(only_exact, 10u);
}

/// Small integers make many flat states and contacts in one instant. All tiers and orders agree, and so does
/// time reversed.
TEST(OracleMotion, DegenerateRandomPairsAgreeInEveryForm) {
    Random random(13);
    std::array<unsigned, 2> counts{};
    for (int round = 0; round < 300; ++round) {
        MovingPair pair;
        for (auto* corners : {&pair.a.from, &pair.a.to, &pair.b.from, &pair.b.to})
            for (auto& corner : *corners)
                for (auto& x : corner) x = static_cast<int>(random.next() % 3);
        for (auto& corner : pair.b.from) corner[0] += 3;
        for (auto& corner : pair.b.to) corner[random.next() % 2] -= 2;
        const auto exact = meet_in_motion(pair.a, pair.b, MeetingTier::polynomials).meeting;
        ASSERT_EQ(meet_in_motion(pair.a, pair.b).meeting, exact) << round;
        const auto other = shuffled(pair, random);
        ASSERT_EQ(meet_in_motion(other.b, other.a, MeetingTier::polynomials).meeting, exact) << round;
        const MovingPair back{straight(pair.a.to, pair.a.from), straight(pair.b.to, pair.b.from)};
        ASSERT_EQ(meet_in_motion(back.a, back.b, MeetingTier::polynomials).meeting, exact) << round;
        if (meets_at_a_step(pair, 60)) {
            ASSERT_EQ(exact, Meeting::meeting) << round;
        }
        const auto at_ends = relation(pair.a.to, pair.b.to) != Relation::disjoint;
        if (!at_ends) ++counts[exact == Meeting::meeting];
    }
    EXPECT_GT(counts[0], 50u);
    EXPECT_GT(counts[1], 50u);
}

TEST(OracleMotion, NonFiniteCoordinatesAreInvalid) {
    auto spoiled = straight(unit, unit);
    spoiled.to[2][1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(meet_in_motion(straight(unit, unit), spoiled).meeting, Meeting::invalid);
}

} // namespace
} // namespace tandem
