// SPDX-License-Identifier: MIT
#include "scenes/hard/maker.h"

#include <cmath>
#include <stdexcept>

namespace tandem::hard {

namespace {

FloatCorners shuffled(Random& random, FloatCorners corners) {
    for (unsigned i = 3; i > 0; --i) std::swap(corners[i], corners[random.next() % (i + 1)]);
    return corners;
}

template<class Narrow>
HardPair pair_of(Random& random, const Corners& a, const Corners& b, Known known, Narrow narrow) {
    HardPair pair{{}, {}, known};
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned axis = 0; axis < 3; ++axis) {
            pair.a[i][axis] = narrow(a[i][axis]);
            pair.b[i][axis] = narrow(b[i][axis]);
        }
    pair.a = shuffled(random, pair.a);
    pair.b = shuffled(random, pair.b);
    return pair;
}

/// Corners of one tetrahedron of touching_integers, on the side with this sign of x.
Corners side(Random& random, unsigned level, int sign) {
    Corners corners;
    for (auto& c : corners)
        c = Eigen::Vector3d{1.0 * sign * whole(random, 1, 4), 1.0 * whole(random, -4, 4),
                            1.0 * whole(random, -4, 4)};
    const Eigen::Vector3d p{0, 1.0 * whole(random, 1, 4), 1.0 * whole(random, -4, 4)};
    const Eigen::Vector3d q{0, 1.0 * whole(random, -4, 4), 1.0 * whole(random, 1, 4)};
    if (level == 1) corners[0].setZero();
    if (level >= 2) corners[0] = p;
    if (level == 2) corners[1] = -p;
    if (level == 3) {
        corners[1] = q;
        corners[2] = -p - q;
    }
    return corners;
}

Corners solid_side(Random& random, unsigned level, int sign) {
    for (;;) {
        auto corners = side(random, level, sign);
        if (determinant(corners) != 0) return corners;
    }
}

} // namespace

int whole(Random& random, int low, int high) {
    return low + static_cast<int>(random.next() % (static_cast<unsigned>(high - low) + 1u));
}

float exact(double x) {
    const auto narrow = static_cast<float>(x);
    if (static_cast<double>(narrow) != x)
        throw std::logic_error("a constructed coordinate is not exact in single precision");
    return narrow;
}

HardPair exact_pair(Random& random, const Corners& a, const Corners& b, Known known) {
    return pair_of(random, a, b, known, exact);
}

HardPair rounded_pair(Random& random, const Corners& a, const Corners& b, Known known) {
    return pair_of(random, a, b, known, [](double x) { return static_cast<float>(x); });
}

Corners moved(Corners corners, const Eigen::Vector3d& by) {
    for (auto& c : corners) c += by;
    return corners;
}

Corners scaled(Corners corners, double by) {
    for (auto& c : corners) c *= by;
    return corners;
}

double determinant(const Corners& corners) {
    const Eigen::Vector3d p = corners[1] - corners[0], q = corners[2] - corners[0],
                          r = corners[3] - corners[0];
    return p.cross(q).dot(r);
}

Corners random_tetrahedron(Random& random) {
    for (;;) {
        Corners corners;
        for (auto& c : corners)
            for (auto& x : c) x = random.uniform(-1, 1);
        if (std::abs(determinant(corners)) > 0.05) return corners;
    }
}

std::pair<Corners, Corners> near_pair(Random& random) {
    const auto a = random_tetrahedron(random);
    const auto b = random_tetrahedron(random);
    return {a, moved(b, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)})};
}

Eigen::Vector3d across(Random& random, const Eigen::Vector3d& axis) {
    for (;;) {
        Eigen::Vector3d other = axis.cross(random.direction());
        if (other.norm() > 0.3 * axis.norm()) return other;
    }
}

std::pair<Corners, Corners> touching_integers(Random& random, unsigned level_a, unsigned level_b) {
    const auto a = solid_side(random, level_a, -1);
    return {a, solid_side(random, level_b, 1)};
}

Eigen::Matrix3d integer_map(Random& random, int bits, double least_stretch) {
    const int largest = 1 << bits;
    for (;;) {
        std::int64_t m[3][3];
        for (auto& row : m)
            for (auto& x : row) x = whole(random, -largest, largest);
        const auto stretch = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
                             - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
                             + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]); // below 2^60
        if (std::abs(static_cast<double>(stretch)) < least_stretch) continue;
        Eigen::Matrix3d map;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) map(i, j) = static_cast<double>(m[i][j]);
        return map;
    }
}

Corners mapped(const Eigen::Matrix3d& map, const Corners& corners, const Eigen::Vector3d& by) {
    Corners result;
    for (unsigned i = 0; i < 4; ++i)
        for (int row = 0; row < 3; ++row)
            result[i][row] =
                ((map(row, 0) * corners[i].x() + map(row, 1) * corners[i].y()) + map(row, 2) * corners[i].z())
                + by[row];
    return result;
}

double float_unit(double x) {
    int exponent = 0;
    std::frexp(x, &exponent); // x in [2^(exponent - 1), 2^exponent)
    return std::ldexp(1.0, exponent - 24);
}

} // namespace tandem::hard
