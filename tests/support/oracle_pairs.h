// SPDX-License-Identifier: MIT
#pragma once

#include "tests/support/oracle_touch.h"

namespace tandem::support {

/// Families of random pairs that are close to each other and whose relation is not known.
enum class Family {
    generic,
    far_origin,
    sliver,
    needle,
    mixed_exponents,
    scale_ratio,
    tiny,
    near_touch,
    count
};

inline const char* name(Family family) {
    constexpr const char* names[] = {"generic",         "far origin",  "sliver", "needle",
                                     "mixed exponents", "scale ratio", "tiny",   "near touch"};
    return names[static_cast<unsigned>(family)];
}

inline double as_float(double x) {
    const volatile auto narrow = static_cast<float>(x);
    return static_cast<double>(narrow);
}

/// Moves corner 3 of b onto the face of a's corners 0, 1, 2, rounded, and the rest of b to the side opposite
/// to a.
inline void put_on_face(OraclePair& pair) {
    auto& [a, b] = pair;
    const auto above = [&](const std::array<double, 3>& corner) {
        return TouchMaker::determinant({a[0], a[1], a[2], corner});
    };
    for (unsigned k = 0; k < 3; ++k) b[3][k] = 0.25 * a[0][k] + 0.3 * a[1][k] + 0.45 * a[2][k];
    for (unsigned i = 0; i < 3; ++i)
        if ((above(b[i]) > 0) == (above(a[3]) > 0))
            for (unsigned k = 0; k < 3; ++k) b[i][k] = 2 * b[3][k] - b[i][k];
}

inline OraclePair random_pair(Family family, Random& random) {
    OraclePair pair;
    for (auto* corners : {&pair.a, &pair.b})
        for (auto& corner : *corners)
            for (auto& x : corner) x = random.uniform(-1, 1);
    const double shift = random.uniform(-0.5, 0.5);
    for (auto& corner : pair.b) corner[0] += shift;
    auto& [a, b] = pair;
    for (unsigned k = 0; k < 3; ++k) {
        if (family == Family::sliver) a[3][k] = (a[0][k] + a[1][k] + a[2][k]) / 3 + 1e-6 * a[3][k];
        if (family == Family::needle)
            for (unsigned i = 1; i < 4; ++i) a[i][k] = a[0][k] + (i == 3 ? a[i][k] : 1e-6 * a[i][k]);
        if (family == Family::scale_ratio)
            for (auto& corner : b) corner[k] *= 1e-6;
    }
    if (family == Family::near_touch) put_on_face(pair);
    return changed(pair, [&](double x) {
        if (family == Family::far_origin) x += 1000;
        if (family == Family::mixed_exponents) x = std::copysign(std::pow(10.0, -30 * std::abs(x)), x);
        if (family == Family::tiny) x *= 1e-42;
        return as_float(x);
    });
}

} // namespace tandem::support
