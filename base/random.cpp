// SPDX-License-Identifier: MIT
#include "base/random.h"

#include <cmath>

namespace tandem {

/// The constants are those of SplitMix64.
std::uint64_t Random::next() {
    state_ += 0x9e3779b97f4a7c15u;
    auto x = state_;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

double Random::uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

Eigen::Vector3d Random::direction() {
    while (true) {
        const double x = uniform(-1, 1);
        const double y = uniform(-1, 1);
        const double z = uniform(-1, 1);
        const double square = (x * x + y * y) + z * z;
        if (square > 1 || square < 1e-6) continue;
        const double length = std::sqrt(square);
        return {x / length, y / length, z / length};
    }
}

Eigen::Quaterniond Random::rotation() {
    while (true) {
        const double w = uniform(-1, 1);
        const double x = uniform(-1, 1);
        const double y = uniform(-1, 1);
        const double z = uniform(-1, 1);
        const double square = (w * w + x * x) + (y * y + z * z);
        if (square > 1 || square < 1e-6) continue;
        const double length = std::sqrt(square);
        return {w / length, x / length, y / length, z / length};
    }
}

SineCosine sine_cosine(double angle) {
    // pi/2 as a 33-bit head, whose products with small integers are exact, and a tail (Cody and Waite 1980).
    constexpr double head = 0x1.921fb544p0;
    constexpr double tail = 0x1.0b4611a626331p-34;
    const double quarters = std::floor(angle / (head + tail) + 0.5);
    const double r = (angle - quarters * head) - quarters * tail;
    const double s = r * r;
    double sine = 0;
    double cosine = 0;
    for (int n = 10; n >= 1; --n) {
        sine = (1 + sine) * (-s / (2 * n * (2 * n + 1)));
        cosine = (1 + cosine) * (-s / (2 * n * (2 * n - 1)));
    }
    sine = r + r * sine;
    cosine = 1 + cosine;
    switch (static_cast<long>(quarters) & 3) {
    case 0:
        return {sine, cosine};
    case 1:
        return {cosine, -sine};
    case 2:
        return {-sine, -cosine};
    default:
        return {-cosine, sine};
    }
}

} // namespace tandem
