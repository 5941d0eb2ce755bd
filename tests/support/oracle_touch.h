// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"
#include "base/random.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tandem::support {

/// Two tetrahedra whose coordinates are representable as float.
struct OraclePair {
    TetraCorners a, b;
};

inline constexpr TetraCorners unit{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

inline TetraCorners moved(TetraCorners t, double x, double y, double z) {
    for (auto& corner : t) corner = {corner[0] + x, corner[1] + y, corner[2] + z};
    return t;
}

inline bool all_floats(const OraclePair& pair) {
    for (const auto* corners : {&pair.a, &pair.b})
        for (const auto& corner : *corners)
            for (const double x : corner) {
                const volatile auto narrow = static_cast<float>(x);
                if (static_cast<double>(narrow) != x) return false;
            }
    return true;
}

template<class Change>
OraclePair changed(OraclePair pair, Change change) {
    for (auto* corners : {&pair.a, &pair.b})
        for (auto& corner : *corners)
            for (auto& x : corner) x = change(x);
    return pair;
}

/// Pairs that touch by construction. Each has a plane, a tetrahedron on each side of it, and a corner, an
/// edge or a face of each tetrahedron in it, all through one common point. An integer matrix then maps the
/// pair, which is translated and shuffled. All integers have at most 24 bits, so they are exact as floats.
class TouchMaker {
public:
    explicit TouchMaker(std::uint64_t seed) : random_(seed) {}

    /// Number of corners in the plane: 1 a corner, 2 an edge, 3 a face. `largest` bounds the matrix entries.
    OraclePair touching(unsigned corners_a, unsigned corners_b, int largest) {
        for (;;) {
            OraclePair pair{side(corners_a, -1), side(corners_b, 1)};
            std::array<std::array<double, 3>, 3> map{};
            for (auto& row : map)
                for (auto& x : row) x = integer(-largest, largest);
            normal_ = minors(map);
            const std::array<double, 3> by{offset(), offset(), offset()};
            const double stretch = map[0][0] * normal_[0] + map[1][0] * normal_[1] + map[2][0] * normal_[2];
            const bool solid = determinant(pair.a) != 0 && determinant(pair.b) != 0;
            if (!solid || std::abs(stretch) < least_stretch_) continue;
            for (auto* corners : {&pair.a, &pair.b})
                for (auto& corner : *corners) corner = mapped(map, corner, by);
            return shuffled(pair);
        }
    }

    /// Two coplanar faces around a common interior point. Then b moves by one unit, the distance between
    /// neighbouring floats at that magnitude, along the axis nearest to the normal: away from a (+1) or into
    /// it (-1).
    OraclePair one_ulp(int direction) {
        base_ = 1 << 23 | 1 << 22;
        least_stretch_ = 0x1p45; // one unit is then below 2^-10 of its length before the map
        auto pair = touching(3, 3, 1 << 17);
        base_ = 0;
        least_stretch_ = 1;
        const auto smaller = [](double p, double q) { return std::abs(p) < std::abs(q); };
        const auto axis = std::max_element(normal_.begin(), normal_.end(), smaller) - normal_.begin();
        const auto component = static_cast<unsigned>(axis);
        double along = 0; // component along the normal, from a to b
        for (unsigned i = 0; i < 4; ++i)
            for (unsigned k = 0; k < 3; ++k) along += normal_[k] * (pair.b[i][k] - pair.a[i][k]);
        const bool outwards = (along > 0) == (normal_[component] > 0);
        for (auto& corner : pair.b) corner[component] += outwards ? direction : -direction;
        return pair;
    }

    /// b is a scaled by one half about its centroid.
    OraclePair nested() {
        for (;;) {
            OraclePair pair;
            for (auto& corner : pair.a)
                for (auto& x : corner) x = 8 * integer(-1000, 1000);
            for (unsigned k = 0; k < 3; ++k) {
                const double sum = pair.a[0][k] + pair.a[1][k] + pair.a[2][k] + pair.a[3][k];
                for (unsigned i = 0; i < 4; ++i) pair.b[i][k] = pair.a[i][k] / 2 + sum / 8;
            }
            if (determinant(pair.a) != 0) return shuffled(pair);
        }
    }

    OraclePair shuffled(OraclePair pair) {
        for (auto* corners : {&pair.a, &pair.b})
            for (unsigned i = 3; i > 0; --i) std::swap((*corners)[i], (*corners)[random_.next() % (i + 1)]);
        return pair;
    }

    /// Six times the volume; exact for integers of 15 bits.
    static double determinant(const TetraCorners& t) {
        double d[3][3];
        for (unsigned i = 0; i < 3; ++i)
            for (unsigned k = 0; k < 3; ++k) d[i][k] = t[i + 1][k] - t[0][k];
        return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1])
               - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0])
               + d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
    }

private:
    double integer(int low, int high) {
        return low + static_cast<int>(random_.next() % static_cast<unsigned>(high - low + 1));
    }
    double offset() { return base_ == 0 ? integer(-1000, 1000) : base_; }

    /// `level` corners lie in the plane x = 0 with the origin between them; the remaining x have the sign
    /// `sign`.
    TetraCorners side(unsigned level, double sign) {
        TetraCorners result{};
        for (auto& corner : result) corner = {sign * integer(1, 4), integer(-4, 4), integer(-4, 4)};
        const std::array<double, 3> p{0, integer(1, 4), integer(-4, 4)}, q{0, integer(-4, 4), integer(1, 4)};
        if (level == 1) result[0] = {0, 0, 0};
        if (level == 2) {
            result[0] = p;
            result[1] = {0, -p[1], -p[2]};
        }
        if (level == 3) {
            result[0] = p;
            result[1] = q;
            result[2] = {0, -p[1] - q[1], -p[2] - q[2]};
        }
        return result;
    }

    static std::array<double, 3> mapped(const std::array<std::array<double, 3>, 3>& map,
                                        const std::array<double, 3>& x, const std::array<double, 3>& by) {
        std::array<double, 3> result;
        for (unsigned i = 0; i < 3; ++i)
            result[i] = map[i][0] * x[0] + map[i][1] * x[1] + map[i][2] * x[2] + by[i];
        return result;
    }

    /// Normal of the image of the plane x = 0.
    static std::array<double, 3> minors(const std::array<std::array<double, 3>, 3>& m) {
        return {m[1][1] * m[2][2] - m[2][1] * m[1][2], m[2][1] * m[0][2] - m[0][1] * m[2][2],
                m[0][1] * m[1][2] - m[1][1] * m[0][2]};
    }

    Random random_;
    std::array<double, 3> normal_{};
    double base_ = 0;
    double least_stretch_ = 1; ///< lower bound for the map's determinant
};

} // namespace tandem::support
