// SPDX-License-Identifier: MIT
// Group a: errors of bounding by k-DOPs.
#include "scenes/hard/families.h"
#include "scenes/hard/maker.h"
#include "scenes/motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tandem::hard {

namespace {

using Vector = Eigen::Vector3d;

/// The directions of k = 26, one for each pair of opposite planes.
const std::array<Vector, 13> directions{
    Vector{1, 0, 0},  Vector{0, 1, 0},   Vector{0, 0, 1}, Vector{1, 1, 1},  Vector{1, 1, -1},
    Vector{1, -1, 1}, Vector{1, -1, -1}, Vector{1, 1, 0}, Vector{1, -1, 0}, Vector{1, 0, 1},
    Vector{1, 0, -1}, Vector{0, 1, 1},   Vector{0, 1, -1}};

/// A random integer combination of two vectors, with factors up to `reach`.
Vector in_plane(Random& random, const Vector& u, const Vector& v, int reach) {
    const double p = whole(random, -reach, reach);
    const double q = whole(random, -reach, reach);
    return p * u + q * v;
}

/// A random integer vector with d.w > 0 whose components are multiples of `steps`.
Vector above(Random& random, const Vector& d, int reach, const Vector& steps) {
    for (;;) {
        Vector w;
        for (int i = 0; i < 3; ++i) w[i] = steps[i] * whole(random, -reach, reach);
        const double height = d.dot(w);
        if (height != 0) return height > 0 ? w : Vector(-w);
    }
}

/// The plane through c with normal d; u and v are in it.
struct Plane {
    Vector c, d, u, v;
};

/// Two tetrahedra of integers that touch at c of a plane. A face of a contains c in the plane, with the tip
/// below. b has a corner at c and the rest above. With weights other than 1 all corners of the face can round
/// in the same direction, which corners with sum 0 cannot.
std::pair<Corners, Corners> touching_across(Random& random, const Plane& plane, int reach,
                                            const Vector& steps) {
    const auto& [c, d, u, v] = plane;
    for (;;) {
        const Vector p = in_plane(random, u, v, reach), q = in_plane(random, u, v, reach);
        const double weights[2]{1.0 * whole(random, 1, 2), 1.0 * whole(random, 1, 2)};
        const Corners a{c + p, c + q, c - weights[0] * p - weights[1] * q,
                        c - above(random, d, reach, steps)};
        Corners b{c, c, c, c};
        for (unsigned i = 1; i < 4; ++i) b[i] += above(random, d, reach, steps);
        const Vector area = p.cross(q);
        const Vector x = b[1] - c, y = b[2] - c, z = b[3] - c;
        if (!area.isZero(0) && x.cross(y).dot(z) != 0) return {a, b};
    }
}

/// Size of a tetrahedron of about 1 in lattice units, at least 4, and small enough to keep the offset's
/// binade.
int reach_of(double unit) { return static_cast<int>(std::clamp(0.25 / unit, 4.0, 0x1p17)); }

HardPair slab_touch(Random& random, double offset, std::uint64_t index) {
    const Vector& d = directions[index % directions.size()];
    const Vector u = d.cross(d.x() != 0 && d.y() == 0 && d.z() == 0 ? Vector{0, 1, 0} : Vector{1, 0, 0});
    const Vector v = d.cross(u);
    const double unit = float_unit(2 * offset);
    Vector c;
    for (auto& x : c) x = std::round(random.uniform(-offset, offset) / unit);
    const auto [a, b] = touching_across(random, {c, d, u, v}, reach_of(unit), {1, 1, 1});
    return exact_pair(random, scaled(a, unit), scaled(b, unit), Known::touching);
}

/// The plane x + y + z = const. One of x and y is odd, the other even, so that x + y needs 25 bits. z is
/// about
/// -(x + y), so that the rounding error is as large as the complete sum. Signs map it to the other diagonals.
HardPair corner_cancellation(Random& random, double offset, std::uint64_t index) {
    const double unit = float_unit(offset);
    const double x = std::round(random.uniform(1.25 * 0x1p23, 1.5 * 0x1p23));
    const double y =
        2 * std::round(random.uniform(1.25 * 0x1p22, 1.5 * 0x1p22)) + (std::fmod(x, 2) == 0 ? 1 : 0);
    const Vector c{x, y, -(x + y - 1) - 2 * whole(random, -2, 2)};
    const int reach = std::min(reach_of(unit), 1 << 16);
    const auto [a, b] = touching_across(random, {c, {1, 1, 1}, {1, -1, 0}, {1, 1, -2}}, reach, {1, 1, 2});
    const Vector signs = directions[3 + index % 4] * unit;
    const auto reflected = [&](Corners corners) {
        for (auto& corner : corners) corner = corner.cwiseProduct(signs);
        return corners;
    };
    return exact_pair(random, reflected(a), reflected(b), Known::touching);
}

HardPair far_origin(Random& random, double offset, std::uint64_t) {
    const auto [a, b] = near_pair(random);
    const Vector by = Vector::Constant(offset);
    return rounded_pair(random, moved(a, by), moved(b, by));
}

/// Touching in mesh coordinates; the oracle decides after the transform.
HardPair touching_at_rest(Random& random, double, std::uint64_t index) {
    const auto [a, b] = touching_integers(random, 1 + static_cast<unsigned>(index % 3),
                                          1 + static_cast<unsigned>(index / 3 % 3));
    const auto map = integer_map(random, 3);
    return exact_pair(random, scaled(mapped(map, a, Vector::Zero()), 0x1p-6),
                      scaled(mapped(map, b, Vector::Zero()), 0x1p-6));
}

Pose far_pose(Random& random, double distance) {
    Pose pose;
    pose.rotation = random.rotation();
    pose.translation = distance * random.direction();
    return pose;
}

double rounded(double x) { return static_cast<double>(static_cast<float>(x)); }

/// A pose after many steps that are rounded to single precision and not corrected.
Pose accumulated_pose(Random& random, double steps) {
    const auto step = turn(random.direction(), 0.01);
    const Vector by = 0.001 * random.direction();
    Pose pose;
    for (int i = 0; i < static_cast<int>(steps); ++i) {
        pose.rotation = product(step, pose.rotation);
        for (auto& x : pose.rotation.coeffs()) x = rounded(x);
        pose.translation = rotated(step, pose.translation) + by;
        for (auto& x : pose.translation) x = rounded(x);
    }
    return pose;
}

/// A rotation whose quaternion has the squared norm 1 + difficulty.
Pose long_pose(Random& random, double difficulty) {
    Pose pose;
    pose.rotation = random.rotation();
    pose.rotation.coeffs() *= std::sqrt(1 + difficulty);
    pose.translation = random.direction();
    return pose;
}

/// A pair and its mirror image x -> -x.
HardPair mirrored(Random& random, double gap, std::uint64_t index) {
    auto [a, b] = near_pair(random);
    b = moved(b, gap * random.direction());
    auto pair = rounded_pair(random, a, b);
    if (index % 2 == 0) return pair;
    for (auto* corners : {&pair.a, &pair.b})
        for (auto& corner : *corners) corner[0] = -corner[0];
    return pair;
}

/// Tetrahedra of two plates, one above the other, whose distance is similar to their thickness.
HardPair thin_plates(Random& random, double thickness, std::uint64_t) {
    const Vector normal = random.direction();
    const Vector u = across(random, normal).normalized();
    const Vector v = normal.cross(u);
    Corners plates[2];
    for (auto& plate : plates)
        for (unsigned i = 0; i < 4; ++i) {
            plate[i] = (i == 3 ? thickness : 0.0) * normal;
            plate[i] += random.uniform(-1, 1) * u;
            plate[i] += random.uniform(-1, 1) * v;
        }
    return rounded_pair(random, plates[0], moved(plates[1], random.uniform(-2, 2) * thickness * normal));
}

/// Even pairs touch: they are integers times 2^-halvings. Odd pairs are random and rounded.
HardPair subnormal(Random& random, double halvings, std::uint64_t index) {
    const double scale = std::ldexp(1.0, -static_cast<int>(halvings));
    if (index % 2 == 0) {
        const auto [a, b] = touching_integers(random, 1 + static_cast<unsigned>(index / 2 % 3),
                                              1 + static_cast<unsigned>(index / 6 % 3));
        const auto map = integer_map(random, 3);
        return exact_pair(random, scaled(mapped(map, a, Vector::Zero()), scale),
                          scaled(mapped(map, b, Vector::Zero()), scale), Known::touching);
    }
    const auto [a, b] = near_pair(random);
    return rounded_pair(random, scaled(a, 64 * scale), scaled(b, 64 * scale));
}

HardPair not_finite(Random& random, double corner, std::uint64_t index) {
    const auto [a, b] = near_pair(random);
    auto pair = rounded_pair(random, a, b, Known::invalid);
    const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity()};
    const auto which = static_cast<unsigned>(corner);
    auto& corners = which < 4 ? pair.a : pair.b;
    corners[which % 4][index % 3] = bad[index / 3 % 3];
    return pair;
}

constexpr HardFamily bounding_table[] = {
    {.row = 1,
     .group = 'a',
     .name = "slab-touch",
     .summary =
         "a corner on a face perpendicular to a k-DOP direction, on the lattice of units in the last place",
     .knob = {"largest coordinate", 1, 1e6, 100},
     .truth = HardTruth::construction,
     .metric = "MISS",
     .fails = "directions of unit length miss 4 to 9 %, at any distance",
     .pair = slab_touch},
    {.row = 2,
     .group = 'a',
     .name = "corner-cancellation",
     .summary = "touching along a cube diagonal where x + y rounds and z cancels it",
     .knob = {"largest coordinate", 1, 1e6, 100},
     .truth = HardTruth::construction,
     .metric = "MISS",
     .fails = "integer diagonals rounded to nearest, and widened by one unit in the last place",
     .pair = corner_cancellation},
    {.row = 3,
     .group = 'a',
     .name = "far-origin",
     .summary = "random near pairs, moved far from the origin and rounded",
     .knob = {"added to every coordinate", 1, 1e7, 1e4},
     .truth = HardTruth::oracle,
     .metric = "MISS, FPR",
     .fails = "wide diagonals: with k = 26 false pairs double at 1e6",
     .pair = far_origin},
    {.row = 4,
     .group = 'a',
     .name = "rigid-transform",
     .summary = "touching at rest, then rotated at random and moved",
     .knob = {"distance moved", 0, 1e6, 10},
     .truth = HardTruth::oracle,
     .metric = "MISS, drift",
     .fails = "poses applied in place; contact at rest is none after rounding",
     .pair = touching_at_rest,
     .pose = far_pose},
    {.row = 5,
     .group = 'a',
     .name = "accumulated-motion",
     .summary = "touching at rest, moved by a pose made of many rounded steps",
     .knob = {"steps", 1, 100000, 1000},
     .truth = HardTruth::oracle,
     .metric = "MISS, drift",
     .fails = "drift grows with the steps",
     .pair = touching_at_rest,
     .pose = accumulated_pose},
    {.row = 6,
     .group = 'a',
     .name = "long-quaternion",
     .summary = "touching at rest, rotated by a quaternion that is not of unit length",
     .knob = {"squared norm - 1", -0.5, 1, 1e-6},
     .truth = HardTruth::oracle,
     .metric = "MISS, size drift",
     .fails = "rotation formulas that take unit length for granted scale the body",
     .pair = touching_at_rest,
     .pose = long_pose},
    {.row = 7,
     .group = 'a',
     .name = "mirror",
     .summary = "random pairs and their mirror images",
     .knob = {"distance moved apart", 0, 2, 0.5},
     .truth = HardTruth::oracle,
     .metric = "SYM",
     .fails = "sets of directions without symmetry: k = 16, k = 24, one diagonal beside the axes",
     .pair = mirrored,
     .twins = true},
    {.row = 8,
     .group = 'a',
     .name = "thin-plates",
     .summary = "tetrahedra of thin plates above each other, rotated at random",
     .knob = {"thickness", 1e-6, 1, 1e-3},
     .truth = HardTruth::oracle,
     .metric = "FPR",
     .fails = "every k-DOP: false pairs grow as plates get thinner",
     .pair = thin_plates},
    {.row = 9,
     .group = 'a',
     .name = "subnormal",
     .summary = "touching and random pairs so small that coordinates are subnormal",
     .knob = {"halvings", 0, 149, 140},
     .truth = HardTruth::oracle,
     .metric = "MISS",
     .fails = "devices that flush subnormal numbers to zero",
     .pair = subnormal},
    {.row = 10,
     .group = 'a',
     .name = "not-finite",
     .summary = "one coordinate is not a number or infinite",
     .knob = {"corner, 0..3 of a, 4..7 of b", 0, 7, 0},
     .truth = HardTruth::construction,
     .metric = "detected",
     .fails = "minima and maxima drop what is not a number: bounds look sound. Scenes of it are refused, or "
              "skipped",
     .pair = not_finite}};

} // namespace

std::span<const HardFamily> bounding_families() { return bounding_table; }

} // namespace tandem::hard
