// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

namespace tandem {

/// SplitMix64 (Steele, Lea and Flood 2014): the same numbers on every machine, unlike the distributions of
/// the standard library.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next();
    /// Uniform in [0, 1), a multiple of 2^-53.
    double uniform();
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Uniform on the unit sphere; by rejection from the cube.
    Eigen::Vector3d direction();
    /// Uniform over rotations; by rejection from the 4-cube.
    Eigen::Quaterniond rotation();

private:
    std::uint64_t state_;
};

/// Sine and cosine from IEEE operations only, so that poses have the same bits everywhere. Reduction by pi/2
/// in two parts, then Taylor polynomials. Absolute error below 2e-16 for |angle| <= 1e6.
struct SineCosine {
    double sine, cosine;
};
SineCosine sine_cosine(double angle);

} // namespace tandem
