// SPDX-License-Identifier: MIT
// Group c: shapes and sizes that are numerically difficult.
#include "scenes/hard/families.h"
#include "scenes/hard/maker.h"

#include <cmath>

namespace tandem::hard {

namespace {

using Vector = Eigen::Vector3d;

/// A sliver, cap, needle or wedge of thickness e, by the index.
Corners thin(Random& random, double e, std::uint64_t index) {
    auto t = random_tetrahedron(random);
    const Vector off = e * t[3];
    switch (index % 4) {
    case 0:
        t[3] = 0.5 * (t[0] + t[1]) + 0.4 * (t[2] - t[0]) + off;
        break; // sliver: two edges cross
    case 1:
        t[3] = (t[0] + t[1] + t[2]) / 3 + off;
        break; // cap
    case 2:    // needle
        t[1] = t[0] + e * t[1];
        t[2] = t[0] + e * t[2];
        break;
    default:
        t[1] = t[0] + e * t[1]; // wedge: one short edge
    }
    return t;
}

HardPair sliver(Random& random, double e, std::uint64_t index) {
    const auto a = thin(random, e, index);
    const auto b = thin(random, e, index / 4);
    const double apart = index / 16 % 2 == 0 ? 2 * e : 0.5;
    const Vector by = 0.5 * (a[0] + a[2]) - 0.5 * (b[0] + b[2]) + apart * random.direction();
    return rounded_pair(random, a, moved(b, by));
}

/// Edges that cross at the angle e, at most e apart. The rest of each tetrahedron is behind its edge.
HardPair parallel_edges(Random& random, double e, std::uint64_t) {
    const Vector along = random.direction();
    const Vector side = across(random, along).normalized();
    const Vector up = along.cross(side);
    const Vector other = along + e * side;
    const Vector gap = e * random.uniform(-1, 1) * up;
    const Corners a{-along, along, -random.uniform(0.2, 1) * up + 0.5 * side,
                    -random.uniform(0.2, 1) * up - 0.5 * side};
    const Corners b{-other + gap, other + gap, random.uniform(0.2, 1) * up + 0.5 * side,
                    random.uniform(0.2, 1) * up - 0.5 * side};
    return rounded_pair(random, a, b);
}

/// b is e times as large as a and lies on a's face.
HardPair scale_ratio(Random& random, double e, std::uint64_t) {
    const auto a = random_tetrahedron(random);
    const double p = random.uniform(0.1, 0.4), q = random.uniform(0.1, 0.4);
    const Vector foot = (1 - p - q) * a[0] + p * a[1] + q * a[2];
    const auto small = scaled(random_tetrahedron(random), e);
    return rounded_pair(random, a, moved(small, foot + e * random.direction()));
}

HardPair mixed_exponents(Random& random, double spread, std::uint64_t) {
    const auto coordinate = [&] {
        const double fraction = random.uniform(1, 2);
        const auto exponent = -static_cast<int>(random.uniform() * spread);
        return std::ldexp(random.next() % 2 == 0 ? fraction : -fraction, exponent);
    };
    Corners a, b;
    for (auto* corners : {&a, &b})
        for (auto& c : *corners)
            for (auto& x : c) x = coordinate();
    return rounded_pair(random, a, b);
}

/// The same pairs at any scale: integers times a power of two. Even pairs touch.
HardPair any_scale(Random& random, double exponent, std::uint64_t index) {
    const double scale = std::ldexp(1.0, static_cast<int>(exponent));
    auto [a, b] = touching_integers(random, 1 + static_cast<unsigned>(index / 2 % 3),
                                    1 + static_cast<unsigned>(index / 6 % 3));
    const auto map = integer_map(random, 3);
    Vector by = Vector::Zero();
    if (index % 2 == 1)
        for (auto& x : by) x = whole(random, -20, 20);
    return exact_pair(random, scaled(mapped(map, a, Vector::Zero()), scale),
                      scaled(mapped(map, b, by), scale), index % 2 == 0 ? Known::touching : Known::open);
}

/// Two equal corners, or all corners in a plane, on a line, or equal.
HardPair zero_volume(Random& random, double range, std::uint64_t index) {
    const auto corner = [&] {
        Vector c;
        for (auto& x : c) x = whole(random, -static_cast<int>(range), static_cast<int>(range));
        return c;
    };
    Corners a, b;
    for (auto& c : a) c = corner();
    for (auto& c : b) c = corner();
    switch (index % 4) {
    case 0:
        a[3] = a[0];
        break;
    case 1:
        a[3] = a[0] + a[1] - a[2];
        break;
    case 2:
        a[2] = 2 * a[1] - a[0];
        a[3] = 2 * a[0] - a[1];
        break;
    default:
        a[1] = a[2] = a[3] = a[0];
    }
    return exact_pair(random, a, b);
}

constexpr HardFamily shape_table[] = {
    {.row = 21,
     .group = 'c',
     .name = "sliver",
     .summary = "slivers, caps, needles and wedges near each other",
     .knob = {"thickness", 1e-12, 0.1, 1e-6},
     .truth = HardTruth::oracle,
     .metric = "CLS, FPR",
     .fails = "k = 6 reports 16 times what meets",
     .pair = sliver},
    {.row = 22,
     .group = 'c',
     .name = "parallel-edges",
     .summary = "edges that cross at a small angle",
     .knob = {"angle", 1e-8, 0.1, 1e-6},
     .truth = HardTruth::oracle,
     .metric = "CLS, ANG",
     .fails = "axes left out for being short; single precision: depth wrong by a factor of 5.8",
     .pair = parallel_edges},
    {.row = 23,
     .group = 'c',
     .name = "scale-ratio",
     .summary = "a small tetrahedron at the face of a large one",
     .knob = {"size of the small one", 1e-8, 1, 1e-4},
     .truth = HardTruth::oracle,
     .metric = "CLS, DULP",
     .fails = "single precision: depth wrong by 3.6 %",
     .pair = scale_ratio},
    {.row = 24,
     .group = 'c',
     .name = "mixed-exponents",
     .summary = "coordinates of very different exponents",
     .knob = {"spread of binary exponents", 0, 120, 100},
     .truth = HardTruth::oracle,
     .metric = "CLS",
     .fails = "double precision: 27 false of 2000",
     .pair = mixed_exponents},
    {.row = 25,
     .group = 'c',
     .name = "scale",
     .summary = "equal pairs at another scale",
     .knob = {"binary exponent of the scale", -140, 100, -60},
     .truth = HardTruth::oracle,
     .metric = "INV, CLS",
     .fails = "products of three single-precision numbers underflow below 1e-13 and overflow above 1e12",
     .pair = any_scale},
    {.row = 26,
     .group = 'c',
     .name = "zero-volume",
     .summary = "corners that are equal, in a plane or on a line",
     .knob = {"largest coordinate", 1, 1000, 10},
     .truth = HardTruth::program,
     .metric = "CLS",
     .fails = "CGAL without its checks; 44 separating axes, which are incomplete",
     .pair = zero_volume}};

} // namespace

std::span<const HardFamily> shape_families() { return shape_table; }

} // namespace tandem::hard
