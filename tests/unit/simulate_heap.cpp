// SPDX-License-Identifier: MIT
#include "base/random.h"
#include "scenes/simulate/solve.h"
#include "tests/unit/simulate_rows.h"
#include "tests/unit/simulate_support.h"

#include <gtest/gtest.h>

namespace tandem {

namespace {

using namespace test;

/// Boxes that fall onto each other, 27 of them, turned at random.
World heap(Surface surface) {
    World world(surface);
    Random random(3);
    world.add(box({30, 1, 30}), at(0, -0.5, 0), true);
    for (int i = 0; i < 27; ++i) {
        const Eigen::Vector3d place(0.9 * (i % 3) - 0.9, 0.8 + 1.1 * (i / 9), 0.9 * (i / 3 % 3) - 0.9);
        world.add(box({0.8, 0.5, 0.6}), {random.rotation(), place});
    }
    return world;
}

struct Energetic {
    double start = 0;   ///< J, that the heap can lose by falling
    double rise = 0;    ///< the most in one step, less what corrections lifted
    double kinetic = 0; ///< at the end
    double fastest = 0; ///< the greatest kinetic energy
    double lifted = 0;  ///< in all
};

Energetic energies(World world, int steps) {
    const auto& scene = world.finish();
    Simulation simulation(scene);
    const auto detect = detector(scene);
    Energetic result;
    for (int i = 0; i < steps; ++i) {
        const auto report = simulation.step(detect);
        if (i == 0) result.start = report.kinetic + report.potential - report.energy_change;
        result.rise = std::max(result.rise, report.energy_change - report.lifted);
        result.lifted += report.lifted;
        result.kinetic = report.kinetic;
        result.fastest = std::max(result.fastest, report.kinetic);
    }
    return result;
}

TEST(SimulateHeap, EnergyOnlyFallsButForWhatCorrectionsLift) {
    const auto heaped = energies(heap({0.5, 0}), 450);
    EXPECT_LT(heaped.rise, 1e-4 * heaped.start);
    EXPECT_LT(heaped.kinetic, 0.02 * heaped.fastest);
    EXPECT_GT(heaped.lifted, 0);
    EXPECT_LT(heaped.lifted, 0.1 * heaped.start);
}

/// J, of the second node, whose tensor of inertia is diagonal.
double kinetic(const simulate::Problem& problem) {
    const auto& node = problem.nodes[1];
    double sum = 0.5 * node.velocity.squaredNorm() / node.inverse_mass;
    for (int i = 0; i < 3; ++i) sum += 0.5 * node.spin[i] * node.spin[i] / node.inverse_inertia(i, i);
    return sum;
}

/// A long body that comes down on its end and slides there: friction turns it, and Newton's law gives the
/// end its speed back whatever that takes.
simulate::Problem falling_rod(Random& random) {
    simulate::Problem problem;
    problem.nodes.resize(2);
    auto& node = problem.nodes[1];
    node.velocity = {random.uniform(-3, 3), -1, 0};
    node.spin = {0, 0, random.uniform(-3, 3)};
    node.inverse_mass = 1;
    node.inverse_inertia = Eigen::Vector3d(12, 12, 12).asDiagonal();
    problem.rows = {simulate::row_between({0, 0, 0}, {random.uniform(-0.5, 0.5), -0.3, 0}, 1)};
    auto& row = problem.rows[0];
    row.bias = row.bounce = row.normal.dot(problem.velocity(row));
    return problem;
}

TEST(SimulateHeap, BouncesAddNoEnergy) {
    const SolverSettings settings{.iterations = 10000, .absolute_tolerance = 1e-10};
    Random random(1);
    int gains = 0, kept = 0;
    for (int i = 0; i < 500; ++i) {
        auto newton = falling_rod(random);
        if (newton.rows[0].bounce >= 0) continue; // it parts already
        auto bounded = newton;
        const double before = kinetic(newton);
        simulate::solve(newton, settings, 1);
        const auto report = simulate::solve_bounded(bounded, settings, 1);
        EXPECT_TRUE(report.converged);
        gains += kinetic(newton) > 1.01 * before;
        EXPECT_LT(kinetic(bounded), 1.002 * before + 1e-9) << i;
        if (kinetic(newton) > before) continue;
        ++kept;
        EXPECT_EQ(bounded.rows[0].impulse, newton.rows[0].impulse) << i; // Newton's, where that loses
    }
    EXPECT_GT(gains, 10);
    EXPECT_GT(kept, 10);
}

} // namespace

} // namespace tandem
