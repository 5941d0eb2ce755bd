// SPDX-License-Identifier: MIT
// Group h: pairs that meet on straight paths between two frames, by construction at one or a few times. The
// others miss each other by 2^-e. All coordinates are exact, so that the truth is known.
#include "scenes/hard/families.h"
#include "scenes/hard/pairs_apart.h"

#include <cmath>

namespace tandem::hard {

namespace {

using Vector = Eigen::Vector3d;
using MovingTetrahedra = std::array<MovingCorners, 2>;

MovingCorners at_rest(const Corners& corners) { return {corners, corners}; }

Vector integers(Random& random, int reach) {
    Vector result;
    for (auto& x : result) x = whole(random, -reach, reach);
    return result;
}

/// A corner that grazes a plane: its path is (2 (g - s), 0, 4 g g + up), and the plane is z = 8 s x. So its
/// height over the plane is (4 s - 2 g)^2 + up, with a double root at s = g / 2.
struct Grazing {
    double g, up;

    Vector at(double s) const { return {2 * (g - s), 0, 4 * g * g + up}; }
};

Grazing grazing(Random& random, double up) { return {0.5 * whole(random, 1, 3), up}; }

/// b touches a's face with one corner, and the rest of b is far above the plane.
MovingTetrahedra grazing_vertex(Random& random, double up) {
    const auto path = grazing(random, up);
    const double below = -100 - whole(random, 0, 50);
    MovingTetrahedra result;
    for (const unsigned end : {0u, 1u}) {
        result[0][end] = {Vector{0, -4, 0}, Vector{0, 4, 0}, Vector{4, 0, 32.0 * end}, Vector{1, 0, below}};
        result[1][end] = {path.at(end), Vector{-3, -4, 200}, Vector{3, -4, 208}, Vector{0, 5, 204}};
    }
    return result;
}

/// b touches an edge of a with an edge; a's edge is the only part of a in the plane.
MovingTetrahedra grazing_edge(Random& random, double up) {
    const auto path = grazing(random, up);
    const double below = -100 - whole(random, 0, 50);
    MovingTetrahedra result;
    for (const unsigned end : {0u, 1u}) {
        const Vector aside{0, 3, 0};
        result[0][end] = {Vector{0, 0, 0}, Vector{4, 0, 32.0 * end}, Vector{1, -2, below},
                          Vector{1, 2, below}};
        result[1][end] = {path.at(end) - aside, path.at(end) + aside, Vector{-3, 0, 200}, Vector{3, 1, 208}};
    }
    return result;
}

/// b falls through a sheet of thickness 2^-e, or beside its tip.
MovingTetrahedra tunnelling(Random& random, double miss, double thickness) {
    const Corners sheet{Vector{-8, -8, 0}, Vector{8, -8, 0}, Vector{0, 8, 0}, Vector{0, 0, thickness}};
    const Corners small{Vector{0, 0, 0}, Vector{0.5, 0, 0}, Vector{0, 0.5, 0}, Vector{0, 0, 0.5}};
    const double y = miss > 0 ? 8 + miss : whole(random, -6, 2);
    const double speed = whole(random, 64, 127);
    return {at_rest(sheet), {moved(small, {0, y, speed}), moved(small, {0, y, -speed})}};
}

/// In the plane z = 0, corner (2 s, c, -miss) of b passes the edge from the origin to (2, 2 s, 0) of a where
/// 2 s s = c, which is at an irrational time. The rest of a is above and the rest of b below.
MovingTetrahedra one_instant(Random& random, double miss) {
    const double c = 0.25 * std::array{3, 4, 5, 7}[random.next() % 4];
    const Vector above{0, 0, 1.0 * whole(random, 1, 8)};
    MovingTetrahedra result;
    for (const unsigned end : {0u, 1u}) {
        const double s = end;
        result[0][end] = {Vector{0, 0, 0}, Vector{2, 2 * s, 0}, Vector{0, 1, 0} + above,
                          Vector{1, -1, 0} + above};
        result[1][end] = {Vector{2 * s, c, -miss}, Vector{-1, 0, -1} - above, Vector{3, 0, -1} - above,
                          Vector{0, 4, -1} - above};
    }
    return result;
}

/// Both are flat in the plane z = 0 at s = 1/2, and on different sides of it at all other times. a inverts
/// around the triangle x + y <= 4, and b around corners with x + y >= 4 + 2 miss, or one in the triangle.
MovingTetrahedra inverting_on_the_way(Random& random, double miss) {
    const double height = whole(random, 1, 4);
    const double near = miss > 0 ? 2 + miss : 1;
    const double xy[4][2] = {{near, near}, {9, 2}, {2, 9}, {9, 9}};
    MovingTetrahedra result;
    for (const unsigned end : {0u, 1u}) {
        const double side = end == 0 ? 1 : -1;
        result[0][end] = {Vector{0, 0, 0}, Vector{4, 0, 0}, Vector{0, 4, 0}, Vector{1, 1, side * height}};
        for (unsigned i = 0; i < 4; ++i)
            result[1][end][i] = {xy[i][0], xy[i][1], -side * (height + 1.0 * i * i)};
    }
    return result;
}

/// Edges along x slide over each other in the plane z = 0. b's face is beyond a's in y and touches that edge.
MovingTetrahedra sliding(Random& random, double miss) {
    const double y = 2 + miss;
    const Vector tip = integers(random, 3);
    const Corners a{Vector{-1, 2, 0}, Vector{1, 2, 0}, Vector{tip.x(), 0, 0}, Vector{0, tip.y(), 3}};
    const Corners b{Vector{-1, y, 0}, Vector{1, y, 0}, Vector{tip.z(), 5, 0}, Vector{0, 3, -3}};
    return {at_rest(a), {moved(b, {-8, 0, 0}), moved(b, {8, 0, 0})}};
}

/// Every second pair misses by 2^-exponent.
template<class Make>
Scene missing_by(Random& random, double exponent, Make make) {
    const double distance = std::ldexp(1.0, -static_cast<int>(exponent));
    std::vector<MovingTetrahedra> pairs;
    for (std::uint32_t i = 0; i < pairs_apart; ++i)
        pairs.push_back(make(random, meets_on_the_way(i) ? 0 : distance));
    return moving_pairs(random, pairs);
}

Scene grazing_vertices(Random& random, double e) { return missing_by(random, e, grazing_vertex); }
Scene grazing_edges(Random& random, double e) { return missing_by(random, e, grazing_edge); }
Scene instants(Random& random, double e) { return missing_by(random, e, one_instant); }
Scene inversions(Random& random, double e) { return missing_by(random, e, inverting_on_the_way); }
Scene slides(Random& random, double e) { return missing_by(random, e, sliding); }
Scene tunnels(Random& random, double e) {
    const double thickness = std::ldexp(1.0, -static_cast<int>(e));
    return missing_by(random, e,
                      [&](Random& next, double miss) { return tunnelling(next, miss, thickness); });
}

constexpr HardKnob distance_knob{"binary exponent of the distance of pairs that miss, negated", 1, 20, 16};

constexpr HardFamily moving_table[] = {
    {.row = 49,
     .group = 'h',
     .name = "grazing-vertex",
     .summary = "a corner that touches a moving face in one instant, with a double root",
     .knob = distance_knob,
     .truth = HardTruth::construction,
     .metric = "MISS, FPR over the motion",
     .fails = "tests of both frames; root finders that look for changes of sign",
     .scene = grazing_vertices,
     .meeting = half_of_pairs_apart,
     .motion = true},
    {.row = 50,
     .group = 'h',
     .name = "grazing-edge",
     .summary = "an edge that touches a moving edge in one instant, with a double root",
     .knob = distance_knob,
     .truth = HardTruth::construction,
     .metric = "MISS, FPR over the motion",
     .fails = "tests of both frames; root finders that look for changes of sign",
     .scene = grazing_edges,
     .meeting = half_of_pairs_apart,
     .motion = true},
    {.row = 51,
     .group = 'h',
     .name = "tunnelling",
     .summary = "a fast tetrahedron that passes a thin sheet between two frames",
     .knob = {"binary exponent of thickness and distance, negated", 1, 20, 16},
     .truth = HardTruth::construction,
     .metric = "MISS, FPR over the motion",
     .fails = "tests of both frames, and of any times in between",
     .scene = tunnels,
     .meeting = half_of_pairs_apart,
     .motion = true},
    {.row = 52,
     .group = 'h',
     .name = "one-instant",
     .summary = "a corner that passes an edge in one instant, at an irrational time",
     .knob = distance_knob,
     .truth = HardTruth::construction,
     .metric = "MISS, FPR over the motion",
     .fails = "tests at any times in between",
     .scene = instants,
     .meeting = half_of_pairs_apart,
     .motion = true},
    {.row = 53,
     .group = 'h',
     .name = "inverting-on-the-way",
     .summary = "elements that invert through a plane, where they touch in one instant without volume",
     .knob = distance_knob,
     .truth = HardTruth::construction,
     .metric = "MISS, FPR over the motion",
     .fails = "tests that need a volume or an orientation",
     .scene = inversions,
     .meeting = half_of_pairs_apart,
     .motion = true},
    {.row = 54,
     .group = 'h',
     .name = "sliding-edges",
     .summary = "edges that slide along each other within one plane",
     .knob = distance_knob,
     .truth = HardTruth::construction,
     .metric = "MISS, FPR over the motion",
     .fails = "tests whose polynomials are zero at all times",
     .scene = slides,
     .meeting = half_of_pairs_apart,
     .motion = true}};

} // namespace

std::span<const HardFamily> moving_families() { return moving_table; }

} // namespace tandem::hard
