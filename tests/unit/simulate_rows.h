// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/problem.h"

namespace tandem::unit_test {

/// A contact row between node 0 and node 1, at the given arms.
inline simulate::ContactRow row_between(const Eigen::Vector3d& arm_a, const Eigen::Vector3d& arm_b,
                                        double friction) {
    simulate::ContactRow row;
    row.normal = {0, 1, 0};
    const auto across = simulate::tangents(row.normal);
    row.tangent = across[0];
    row.binormal = across[1];
    row.arm_a = arm_a;
    row.arm_b = arm_b;
    row.friction = friction;
    row.a = {0, false};
    row.b = {1, false};
    return row;
}

} // namespace tandem::unit_test
