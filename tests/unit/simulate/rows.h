// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/problem.h"
#include "scenes/simulate/solve.h"
#include "tests/unit/simulate/support.h"

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

/// The first step of a world: its motion before and after gravity, and its contacts.
struct Beginning {
    explicit Beginning(World& world) : scene(world.finish()) {
        detector(scene)(frame_of(model, motion), contacts);
        kick(model, free, 0.01);
    }

    const Scene& scene;
    simulate::Model model = simulate::make_model(scene);
    simulate::MotionState motion = simulate::starting_motion(model);
    simulate::MotionState free = motion;
    std::vector<ContactPoint> contacts;
};

} // namespace tandem::unit_test
