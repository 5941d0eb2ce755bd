// SPDX-License-Identifier: MIT
// Group h: rotations between two frames, and equal speeds. Every second pair misses.
#include "scenes/hard/families.h"
#include "scenes/hard/pairs_apart.h"
#include "scenes/hard/solids.h"

#include <cmath>

namespace tandem::hard {

namespace {

using Vector = Eigen::Vector3d;

/// Contains the ball of radius 0.28 about the origin and is inside that of radius 0.87.
const Corners around_origin{Vector{0.5, 0.5, 0.5}, Vector{0.5, -0.5, -0.5}, Vector{-0.5, 0.5, -0.5},
                            Vector{-0.5, -0.5, 0.5}};

Pose turned_about_z(double cosine_of_half, double sine_of_half) {
    Pose pose;
    pose.rotation = {cosine_of_half, 0, 0, sine_of_half};
    return pose;
}

template<class Make>
Scene turning(Random& random, Make make) {
    std::vector<TurningCorners> pairs;
    for (std::uint32_t i = 0; i < pairs_apart; ++i) pairs.push_back(make(meets_on_the_way(i)));
    return turning_pairs(random, pairs);
}

/// A bar from the origin to (length, 0, 0) turns by half a turn about z, either way. A small tetrahedron is
/// beside it within its reach, on either side, or beyond its reach.
Scene half_turns(Random& random, double length) {
    return turning(random, [&](bool meets) {
        const Corners bar{Vector{0, -0.5, 0}, Vector{0, 0.5, 0}, Vector{length, 0, -0.5},
                          Vector{length, 0, 0.5}};
        const double radius = meets ? random.uniform(8, length - 4) : length + 2;
        Vector place;
        do {
            place = {random.uniform(-1, 1), random.uniform(-1, 1), 0};
            place *= radius / place.norm();
        } while (std::abs(place.y()) < 0.4 * radius);
        return TurningCorners{
            bar, around_origin, {at({0, 0, 0}), at(place)}, {turned_about_z(0, 1), at(place)}};
    });
}

/// A tetrahedron at a distance from its axis that turns so far that its arc is 8 from the chord. Another one
/// is at the middle of the arc, or at the middle of the chord.
Scene far_levers(Random& random, double distance) {
    const double lever = std::round(distance);
    const double cosine = 1 - 8 / lever;
    const double sine = std::sqrt(1 - cosine * cosine);
    return turning(random, [&](bool meets) {
        const double radius = meets ? lever : lever - 8;
        const auto middle = at({radius * cosine, radius * sine, 0});
        return TurningCorners{moved(around_origin, {lever, 0, 0}),
                              around_origin,
                              {at({0, 0, 0}), middle},
                              {turned_about_z(cosine, sine), middle}};
    });
}

/// A tetrahedron 4096 from its axis turns by 2^-e, so that it moves along y by about 4096 2^-e. A sheet
/// across the way is at half of the distance, or at twice the distance.
Scene tiny_turns(Random& random, double exponent) {
    constexpr double lever = 4096;
    const double angle = std::ldexp(1.0, -static_cast<int>(exponent)), way = lever * angle;
    const double sine = angle / 2; // of half the angle, nearly
    return turning(random, [&](bool meets) {
        const double y = meets ? way / 2 : 2 * way;
        const double tip = whole(random, -2, 2);
        const Corners sheet{Vector{lever - 16, y, -8}, Vector{lever + 16, y, -8},
                            Vector{lever - 2 + tip, y, 8}, Vector{lever - 2, y + way / 16, 0}};
        return TurningCorners{moved(scaled(around_origin, way / 8), {lever, 0, 0}),
                              sheet,
                              {at({0, 0, 0}), at({0, 0, 0})},
                              {turned_about_z(std::sqrt(1 - sine * sine), sine), at({0, 0, 0})}};
    });
}

/// Both move by (v, v, v) with v = 2^exponent. Meanwhile an edge of b passes a parallel edge of a, by two
/// units in the last place of v. The rest of a is above both edges and the rest of b below. b is lower by a
/// unit in pairs that miss.
Scene equal_speeds(Random& random, double exponent) {
    const double v = std::ldexp(1.0, static_cast<int>(exponent)), unit = float_unit(v);
    std::vector<std::array<MovingCorners, 2>> pairs;
    for (std::uint32_t i = 0; i < pairs_apart; ++i) {
        const double down = meets_on_the_way(i) ? 0 : -unit;
        const double y = whole(random, -1, 1);
        const Corners a{Vector{0, 0, 0}, Vector{0, 2, 0}, Vector{-1, 0, 4}, Vector{1, 0, 4}};
        const Corners b{Vector{0, y, down}, Vector{0, y + 2, down}, Vector{-1, 0, -4}, Vector{1, 0, -4}};
        auto first = b, last = b;
        for (unsigned corner = 0; corner < 2; ++corner) {
            first[corner].x() = -unit;
            last[corner].x() = unit;
        }
        pairs.push_back(
            {MovingCorners{a, moved(a, {v, v, v})}, MovingCorners{first, moved(last, {v, v, v})}});
    }
    return moving_pairs(random, pairs);
}

constexpr HardFamily turning_table[] = {
    {.row = 55,
     .group = 'h',
     .name = "half-turn",
     .summary = "a bar that turns by 180 degrees and meets something only on the way",
     .knob = {"length of the bar", 16, 4096, 64},
     .truth = HardTruth::construction,
     .metric = "MISS, FPR over the motion",
     .fails = "bounds of both frames without the arc",
     .scene = half_turns,
     .meeting = half_of_pairs_apart,
     .motion = true},
    {.row = 56,
     .group = 'h',
     .name = "far-lever",
     .summary = "a rotation about a far axis, whose arc is 8 from its chord",
     .knob = {"distance from the axis", 16, 65536, 1024},
     .truth = HardTruth::construction,
     .metric = "MISS, FPR over the motion",
     .fails = "bounds of both frames without the arc, or with the radius of the body about its middle",
     .scene = far_levers,
     .meeting = half_of_pairs_apart,
     .motion = true},
    {.row = 57,
     .group = 'h',
     .name = "tiny-turn",
     .summary = "a tiny rotation about a far axis",
     .knob = {"binary exponent of the angle, negated", 4, 14, 10},
     .truth = HardTruth::construction,
     .metric = "MISS, FPR over the motion",
     .fails = "angles from the cosine alone",
     .scene = tiny_turns,
     .meeting = half_of_pairs_apart,
     .motion = true},
    {.row = 58,
     .group = 'h',
     .name = "equal-speed",
     .summary = "bodies that move equally fast, with a relative motion of two units in the last place",
     .knob = {"binary exponent of the speed", 3, 20, 12},
     .truth = HardTruth::construction,
     .metric = "MISS, FPR over the motion",
     .fails = "relative positions from rounded coordinates",
     .scene = equal_speeds,
     .meeting = half_of_pairs_apart,
     .motion = true}};

} // namespace

std::span<const HardFamily> turning_families() { return turning_table; }

} // namespace tandem::hard
