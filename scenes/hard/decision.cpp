// SPDX-License-Identifier: MIT
// Group c: errors of the overlap decision for tetrahedra that touch or nearly touch.
#include "scenes/hard/families.h"
#include "scenes/hard/maker.h"

#include <cmath>

namespace tandem::hard {

namespace {

using Vector = Eigen::Vector3d;

/// Touching corner, edge or face of each tetrahedron by the index: nine combinations.
std::pair<Corners, Corners> by_index(Random& random, std::uint64_t index) {
    return touching_integers(random, 1 + static_cast<unsigned>(index % 3),
                             1 + static_cast<unsigned>(index / 3 % 3));
}

Vector whole_offset(Random& random, int largest) {
    Vector by;
    for (auto& x : by) x = whole(random, -largest, largest);
    return by;
}

HardPair mapped_pair(Random& random, const std::pair<Corners, Corners>& pair, double bits, Known known) {
    const auto map = integer_map(random, static_cast<int>(bits));
    const Vector by = whole_offset(random, 1000);
    return exact_pair(random, mapped(map, pair.first, by), mapped(map, pair.second, by), known);
}

HardPair touch(Random& random, double bits, std::uint64_t index) {
    return mapped_pair(random, by_index(random, index), bits, Known::touching);
}

/// Two faces in one plane around a common point, mapped to coordinates near 2^23 + 2^22, where the unit in
/// the last place is 1. b is moved by whole units along the axis nearest the normal. The map stretches so
/// much that a unit is below 2^-10 before the map, so that the faces keep a common point.
HardPair units_apart(Random& random, double units, std::uint64_t) {
    const auto [a, b] = touching_integers(random, 3, 3);
    const auto map = integer_map(random, 17, 0x1p45);
    const Vector normal = map.col(1).cross(map.col(2)); // normal of the image of the plane x = 0
    const double outwards = normal.dot(map.col(0)) > 0 ? 1 : -1;
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    Vector by = Vector::Constant(0x1p23 + 0x1p22);
    const auto a_mapped = mapped(map, a, by);
    by[axis] += (normal[axis] > 0 ? outwards : -outwards) * std::round(units);
    const auto known = std::round(units) > 0   ? Known::disjoint
                       : std::round(units) < 0 ? Known::overlapping
                                               : Known::touching;
    return exact_pair(random, a_mapped, mapped(map, b, by), known);
}

/// A corner of b is on a's face 0 1 2, lifted by `lift` units of 2^-24, then rounded. The rest of b is on the
/// other side of the face.
HardPair rounded_onto_face(Random& random, double lift, std::uint64_t) {
    const auto a = random_tetrahedron(random);
    Vector normal = (a[1] - a[0]).cross(a[2] - a[0]).normalized();
    if (normal.dot(a[3] - a[0]) > 0) normal = -normal;
    const double p = random.uniform(0.1, 0.4), q = random.uniform(0.1, 0.4);
    const Vector foot = (1 - p - q) * a[0] + p * a[1] + q * a[2] + lift * 0x1p-24 * normal;
    Corners b{foot, foot, foot, foot};
    for (unsigned i = 1; i < 4; ++i) {
        b[i] += random.uniform(0.3, 1) * normal;
        b[i] += 0.8 * random.direction().cross(normal);
    }
    return rounded_pair(random, a, b);
}

/// Adjacent faces in one plane. Even pairs have a common corner; odd pairs have a gap of one unit before the
/// map.
HardPair coplanar(Random& random, double bits, std::uint64_t index) {
    const double gap = index % 2 == 0 ? 0 : 1;
    Corners sides[2];
    for (int side = 0; side < 2; ++side) {
        const int sign = side == 0 ? -1 : 1;
        do {
            for (auto& c : sides[side]) {
                const double y = sign * whole(random, 1, 4);
                c = Vector{0, y, 1.0 * whole(random, -4, 4)};
            }
            sides[side][0] = Vector{0, side == 0 ? 0 : gap, 0};
            sides[side][3].x() = sign * whole(random, 1, 4);
            if (side == 1)
                for (unsigned i = 1; i < 4; ++i) sides[side][i].y() += gap;
        } while (determinant(sides[side]) == 0);
    }
    return mapped_pair(random, {sides[0], sides[1]}, bits, gap == 0 ? Known::touching : Known::disjoint);
}

/// A common face, edge or corner with equal bits.
HardPair shared(Random& random, double bits, std::uint64_t index) {
    const auto in_common = 3 - static_cast<unsigned>(index % 3);
    for (;;) {
        auto [a, b] = touching_integers(random, 3, 3);
        for (unsigned i = 0; i < in_common; ++i) b[i] = a[i];
        for (unsigned i = in_common; i < 3; ++i) b[i].x() = whole(random, 1, 4);
        if (determinant(b) != 0) return mapped_pair(random, {a, b}, bits, Known::touching);
    }
}

/// b is a copy of a, shrunk about the centroid.
HardPair nested(Random& random, double shrink, std::uint64_t) {
    const auto a = random_tetrahedron(random);
    const Vector middle = 0.25 * ((a[0] + a[1]) + (a[2] + a[3]));
    auto b = a;
    for (auto& c : b) c += shrink * (middle - c);
    return rounded_pair(random, a, b, Known::overlapping);
}

/// Odd pairs are the even pairs with two corners of each tetrahedron swapped, which inverts them.
HardPair inside_out(Random& random, double bits, std::uint64_t index) {
    auto pair = touch(random, bits, index / 2);
    if (index % 2 == 1) {
        std::swap(pair.a[1], pair.a[2]);
        std::swap(pair.b[0], pair.b[3]);
    }
    return pair;
}

constexpr HardFamily decision_table[] = {
    {.row = 14,
     .group = 'c',
     .name = "touch",
     .summary = "corner, edge or face on corner, edge or face: small integers",
     .knob = {"bits of the integer map", 1, 9, 3},
     .truth = HardTruth::construction,
     .metric = "CLS",
     .fails = "distance algorithms with tolerances miss 20 to 55 %",
     .pair = touch},
    {.row = 15,
     .group = 'c',
     .name = "touch-24bit",
     .summary = "touching as in touch, with coordinates of up to 24 bits",
     .knob = {"bits of the integer map", 10, 19, 19},
     .truth = HardTruth::construction,
     .metric = "CLS",
     .fails = "separating axes in single precision miss 4 to 12 %, in double 2 to 7 %",
     .pair = touch},
    {.row = 16,
     .group = 'c',
     .name = "units-apart",
     .summary = "faces in one plane, then moved apart or together by units in the last place",
     .knob = {"units apart", -16, 16, 1},
     .truth = HardTruth::construction,
     .metric = "CLS",
     .fails = "whatever rounds a difference",
     .pair = units_apart},
    {.row = 17,
     .group = 'c',
     .name = "rounded-onto-face",
     .summary = "a corner rounded onto a face",
     .knob = {"lift in units of 2^-24", -1e6, 1e6, 0},
     .truth = HardTruth::oracle,
     .metric = "CLS",
     .fails = "single precision: 45 missed and 655 false of 2000",
     .pair = rounded_onto_face},
    {.row = 18,
     .group = 'c',
     .name = "coplanar",
     .summary = "adjacent faces in one plane, with or without a common corner",
     .knob = {"bits of the integer map", 1, 19, 8},
     .truth = HardTruth::construction,
     .metric = "CLS",
     .fails = "portal refinement misses 55 %",
     .pair = coplanar},
    {.row = 19,
     .group = 'c',
     .name = "shared",
     .summary = "a common face, edge or corner, as between neighbours in a mesh",
     .knob = {"bits of the integer map", 1, 19, 12},
     .truth = HardTruth::construction,
     .metric = "CLS",
     .fails = "filters, which are unsure of all of them",
     .pair = shared},
    {.row = 20,
     .group = 'c',
     .name = "nested",
     .summary = "a copy, shrunk about its centroid",
     .knob = {"shrunk by", 0, 0.99, 0.5},
     .truth = HardTruth::construction,
     .metric = "CLS, DREL",
     .fails = "pushing along one side of an axis only: depth too large",
     .pair = nested},
    {.row = 27,
     .group = 'c',
     .name = "inverted",
     .summary = "touching pairs and the same pairs inverted",
     .knob = {"bits of the integer map", 1, 19, 12},
     .truth = HardTruth::construction,
     .metric = "PERM",
     .fails = "face normals that trust the order of corners",
     .pair = inside_out,
     .twins = true}};

} // namespace

std::span<const HardFamily> decision_families() { return decision_table; }

} // namespace tandem::hard
