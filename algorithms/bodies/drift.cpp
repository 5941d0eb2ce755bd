// SPDX-License-Identifier: MIT
#include "algorithms/bodies/drift.h"

#include <algorithm>
#include <cmath>

namespace tandem {

namespace {

constexpr double matrix_error = 24 * 0x1p-53; ///< bound for an entry that pose_rows computes in double

double roundoff(Precision precision) { return precision == Precision::fp64 ? 0x1p-53 : 0x1p-24; }

/// gamma_n of Higham 2002, lemma 3.1.
double gamma(int n, double u) { return n * u / (1 - n * u); }

/// Enlarges a bound to cover the rounding of its computation, of its conversion to the cell's precision, and
/// of a sum of three bounds in that precision.
double with_slack(double bound, double u) { return bound * (1 + 64 * u); }

} // namespace

double underflow(Precision precision) { return precision == Precision::fp64 ? 0x1p-1060 : 0x1p-140; }

double reach_of(std::span<const Eigen::Vector3d> vertices, const Eigen::Vector3d& shift) {
    double reach = 0;
    for (const auto& v : vertices) reach = std::max(reach, (v + shift).stableNorm());
    return reach;
}

std::array<double, 3> drift_bound(const Pose& pose, double reach, Precision precision,
                                  const Eigen::Vector3d& shift) {
    const double u = roundoff(precision);
    const double distance = shift.stableNorm();
    const double of_matrix = std::sqrt(3.0) * matrix_error * reach;
    const double of_rotation =
        gamma(6, u) * (reach + of_matrix) + of_matrix + underflow(precision) * (1 + reach);
    std::array<double, 3> bound{};
    for (int i = 0; i < 3; ++i) {
        const double along = std::fabs(pose.translation[i]);
        const double of_shift = distance > 0 ? 0x1p-53 * (48 * distance + 2 * along) : 0;
        bound[static_cast<std::size_t>(i)] = with_slack(of_rotation + gamma(2, u) * along + of_shift, u);
    }
    return bound;
}

std::array<double, 3> drift_bound(std::span<const Eigen::Vector3d> world, Precision precision) {
    if (precision == Precision::fp64) return {};
    const double u = roundoff(precision);
    std::array<double, 3> bound{};
    for (const auto& v : world)
        for (int i = 0; i < 3; ++i)
            bound[static_cast<std::size_t>(i)] =
                std::max(bound[static_cast<std::size_t>(i)], std::fabs(v[i]));
    for (auto& b : bound) b = with_slack(u * b + underflow(precision), u);
    return bound;
}

} // namespace tandem
