// SPDX-License-Identifier: MIT
#pragma once

#include "tests/support/oracle_touch.h"

#include <limits>

namespace tandem::support {

/// How one of two tetrahedra is nested in the other.
enum class Nesting {
    concentric,
    identical,
    inside,
    shared_corner,
    shared_edge,
    shared_face,
    on_faces,
    sliver,
    small,
    far_origin,
    scaled,
    count
};

inline const char* name(Nesting nesting) {
    constexpr const char* names[] = {"concentric",          "identical",      "inside",
                                     "a shared corner",     "a shared edge",  "a shared face",
                                     "corners on faces",    "a sliver",       "a 128th in size",
                                     "far from the origin", "scaled by 1e-20"};
    return names[static_cast<unsigned>(nesting)];
}

/// Corners of the inner tetrahedron are means of the outer corners with weights in eighths. So floats
/// represent them, and shared corners are shared exactly.
class NestedMaker {
public:
    explicit NestedMaker(std::uint64_t seed) : random_(seed) {}

    OraclePair make(Nesting nesting) {
        for (;;) {
            OraclePair pair{outer(), {}};
            pair.b = inner(pair.a, nesting);
            if (!is_solid(pair.a) || !is_solid(pair.b)) continue;
            if (random_.next() % 2 == 0) std::swap(pair.a, pair.b);
            if (nesting == Nesting::far_origin)
                for (auto* corners : {&pair.a, &pair.b}) *corners = moved(*corners, 1 << 23, -(1 << 22), 0);
            if (nesting == Nesting::scaled)
                pair = changed(pair,
                               [](double x) { return static_cast<double>(static_cast<float>(x * 1e-20)); });
            return TouchMaker(random_.next()).shuffled(pair);
        }
    }

private:
    using Weights = std::array<double, 4>;

    /// Whether its volume is also certain in float arithmetic.
    static bool is_solid(const TetraCorners& t) {
        double box = 1;
        for (unsigned k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax({t[0][k], t[1][k], t[2][k], t[3][k]});
            box *= high - low;
        }
        return std::abs(TouchMaker::determinant(t)) > 0x1p-16 * box;
    }

    TetraCorners outer() {
        TetraCorners result;
        for (auto& corner : result)
            for (auto& x : corner) x = 64 * (static_cast<int>(random_.next() % 201) - 100);
        return result;
    }

    TetraCorners inner(const TetraCorners& outer, Nesting nesting) {
        TetraCorners result;
        for (unsigned i = 0; i < 4; ++i) {
            auto weights = random_weights(nesting == Nesting::on_faces ? 0 : 1);
            if (nesting == Nesting::concentric) weights = {1, 1, 1, 1}, weights[i] = 5;
            if (i < shared_corners(nesting)) weights = {}, weights[i] = 8;
            result[i] = mean(outer, weights);
        }
        if (nesting == Nesting::sliver) flatten(result);
        if (nesting == Nesting::small) shrink(result, mean(outer, random_weights(1)));
        return result;
    }

    static unsigned shared_corners(Nesting nesting) {
        switch (nesting) {
        case Nesting::shared_corner:
            return 1;
        case Nesting::shared_edge:
            return 2;
        case Nesting::shared_face:
            return 3;
        case Nesting::identical:
            return 4;
        default:
            return 0;
        }
    }

    /// Four weights, each at least `least`, that sum to eight.
    Weights random_weights(double least) {
        Weights weights{least, least, least, least};
        for (double rest = 8 - 4 * least; rest > 0; --rest) weights[random_.next() % 4] += 1;
        return weights;
    }

    static std::array<double, 3> mean(const TetraCorners& corners, const Weights& w) {
        std::array<double, 3> result;
        for (unsigned k = 0; k < 3; ++k)
            result[k] =
                (w[0] * corners[0][k] + w[1] * corners[1][k] + w[2] * corners[2][k] + w[3] * corners[3][k])
                / 8;
        return result;
    }

    /// Moves the last corner to a 64th of its height above the other three.
    static void flatten(TetraCorners& t) {
        for (unsigned k = 0; k < 3; ++k) {
            const double below = (t[0][k] + t[1][k] + 2 * t[2][k]) / 4;
            t[3][k] = std::round(below + (t[3][k] - below) / 64);
        }
    }

    static void shrink(TetraCorners& t, const std::array<double, 3>& to) {
        for (auto& corner : t)
            for (unsigned k = 0; k < 3; ++k) corner[k] = std::round(to[k] + (corner[k] - to[k]) / 128);
    }

    Random random_;
};

/// Distance by which b has to move along the unit vector n so that it only touches a; in long double.
inline double translation_along(const OraclePair& pair, const std::array<double, 3>& n) {
    const auto along = [&n](const std::array<double, 3>& p) {
        return static_cast<long double>(n[0]) * p[0] + static_cast<long double>(n[1]) * p[1]
               + static_cast<long double>(n[2]) * p[2];
    };
    auto high = -std::numeric_limits<long double>::infinity();
    auto low = -high;
    for (const auto& p : pair.a) high = std::max(high, along(p));
    for (const auto& p : pair.b) low = std::min(low, along(p));
    return static_cast<double>(high - low);
}

} // namespace tandem::support
