// SPDX-License-Identifier: MIT
// Times that vary as measured ones do, the same on every machine.
#pragma once

#include "harness/compare/ratio.h"

#include <cmath>
#include <random>
#include <vector>

namespace tandem::compare {

class Noise {
public:
    explicit Noise(std::uint64_t start) : random_(start) {}

    /// From the normal distribution with this deviation, about 0.
    double normal(double deviation) {
        const double share = (static_cast<double>(random_() >> 11) + 0.5) / 9007199254740992.0;
        return deviation * normal_quantile(share);
    }
    std::vector<double> normal(std::size_t count, double deviation) {
        std::vector<double> values(count);
        for (auto& value : values) value = normal(deviation);
        return values;
    }
    /// About 10 ms, in nanoseconds, log-normal.
    std::vector<double> times(std::size_t count, double deviation) {
        auto values = normal(count, deviation);
        for (auto& value : values) value = 1e7 * std::exp(value);
        return values;
    }

private:
    std::mt19937_64 random_;
};

} // namespace tandem::compare
