// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/narrow_phase/reference.h"
#include "geometry/decision.h"

#include <cmath>
#include <limits>
#include <random>

namespace tandem::unit_test {

/// Two tetrahedra, the boundary bits of their faces, and pressures at their corners.
template<class Real>
struct TetrahedronPair {
    Corners<Real> a, b;
    unsigned boundary_a = 15, boundary_b = 15;
    std::array<Real, 4> pressures_a{}, pressures_b{};

    GivenTetrahedron<Real> given_a() const { return {a, boundary_a, pressures_a}; }
    GivenTetrahedron<Real> given_b() const { return {b, boundary_b, pressures_b}; }
};

template<class Real, class Change>
Corners<Real> changed(Corners<Real> corners, Change change) {
    for (auto& corner : corners)
        for (auto& x : corner) x = change(x);
    return corners;
}

template<class Real>
Corners<Real> moved(Corners<Real> corners, const std::array<Real, 3>& by) {
    for (auto& corner : corners)
        for (unsigned axis = 0; axis < 3; ++axis) corner[axis] += by[axis];
    return corners;
}

/// Corners rounded to the precision of a contact stage.
template<class Real = float>
Corners<Real> narrowed(const TetraCorners& corners) {
    Corners<Real> result;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned k = 0; k < 3; ++k) result[i][k] = static_cast<Real>(corners[i][k]);
    return result;
}

/// Pressures at corners: random, many of them 0, or those of one linear field over both tetrahedra.
template<class Real>
class PressureMaker {
public:
    void set(TetrahedronPair<Real>& pair) {
        const auto kind = random_() % 8;
        const auto scale = std::ldexp(Real(1), static_cast<int>(random_() % 61) - 30);
        const std::array<Real, 3> along{value(), value(), value()};
        for (auto [corners, pressures] :
             {std::pair(&pair.a, &pair.pressures_a), {&pair.b, &pair.pressures_b}})
            for (unsigned i = 0; i < 4; ++i) {
                const auto& c = (*corners)[i];
                const Real linear = 8 + c[0] * along[0] + c[1] * along[1] + c[2] * along[2];
                const Real one = kind == 0   ? linear
                                 : kind == 1 ? std::max(value() - Real(0.5), Real(0))
                                             : value();
                (*pressures)[i] =
                    one >= 0 && one < 16 ? scale * one : 0; // some corners are far or not finite
            }
    }

private:
    Real value() { return static_cast<Real>(random_() % 1024) / 1024; }

    std::mt19937 random_{3};
};

/// Families of close pairs. The same seed gives the same pairs on every platform.
template<class Real>
class PairMaker {
public:
    enum Family { generic, lattice, sliver, small, far, mixed_sizes, spoiled, family_count };

    TetrahedronPair<Real> make(Family family) {
        const auto lattice_point = [this] { return static_cast<Real>(static_cast<int>(random_() % 5) - 2); };
        const auto point = [this] { return uniform(); };
        TetrahedronPair<Real> pair{corners(point), corners(point), bits(), bits(), {}, {}};
        if (random_() % 4 != 0) pair.boundary_a = pair.boundary_b = 15;
        if (family == lattice) pair.a = corners(lattice_point), pair.b = corners(lattice_point);
        if (family == sliver) pair.a[3] = between(pair.a, Real(1e-5) * uniform());
        if (family == small) scale(pair, Real(1e-4), Real(1e-4));
        if (family == mixed_sizes) scale(pair, 1, Real(0.01));
        if (family == far) {
            pair.a = moved<Real>(pair.a, {1000, -500, 250});
            pair.b = moved<Real>(pair.b, {1000, -500, 250});
        }
        if (family == spoiled) spoil(pair);
        pressures_.set(pair);
        return pair;
    }

    Real uniform() { return std::ldexp(static_cast<Real>(random_() >> 8), -23) - 1; }

private:
    unsigned bits() { return static_cast<unsigned>(random_() % 16); }

    template<class Coordinate>
    Corners<Real> corners(Coordinate coordinate) {
        Corners<Real> result;
        for (auto& corner : result)
            for (auto& x : corner) x = coordinate();
        return result;
    }

    static std::array<Real, 3> between(const Corners<Real>& c, Real off) {
        return {(c[0][0] + c[1][0] + c[2][0]) / 3 + off, (c[0][1] + c[1][1] + c[2][1]) / 3,
                (c[0][2] + c[1][2] + c[2][2]) / 3};
    }

    static void scale(TetrahedronPair<Real>& pair, Real a, Real b) {
        pair.a = changed(pair.a, [a](Real x) { return x * a; });
        pair.b = changed(pair.b, [b](Real x) { return x * b; });
    }

    void spoil(TetrahedronPair<Real>& pair) {
        const Real values[] = {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity(),
                               std::numeric_limits<Real>::max(), std::numeric_limits<Real>::denorm_min()};
        auto& corners = random_() % 2 == 0 ? pair.a : pair.b;
        if (random_() % 2 == 0)
            corners[random_() % 4][random_() % 3] = values[random_() % 4];
        else
            corners[random_() % 4] = corners[random_() % 4];
    }

    std::mt19937 random_{20240611};
    PressureMaker<Real> pressures_;
};

} // namespace tandem::unit_test
