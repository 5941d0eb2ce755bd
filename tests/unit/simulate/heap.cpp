// SPDX-License-Identifier: MIT
#include "base/random.h"
#include "scenes/simulate/solve.h"
#include "tests/support/test.h"
#include "tests/unit/simulate/rows.h"
#include "tests/unit/simulate/support.h"

namespace tandem {
namespace {

using namespace unit_test;

/// 27 randomly rotated boxes that fall onto each other.
World heap(Surface surface) {
    World world(surface);
    Random random(3);
    world.add(box({30, 1, 30}), at(0, -0.5, 0), true);
    for (int i = 0; i < 27; ++i) {
        const Eigen::Vector3d position(0.9 * (i % 3) - 0.9, 0.8 + 1.1 * (i / 9), 0.9 * (i / 3 % 3) - 0.9);
        world.add(box({0.8, 0.5, 0.6}), {random.rotation(), position});
    }
    return world;
}

struct Energetic {
    double start = 0;   ///< J, potential energy that the heap can lose by falling
    double rise = 0;    ///< largest gain in one step, minus the work of corrections
    double kinetic = 0; ///< at the end
    double fastest = 0; ///< largest kinetic energy
    double lifted = 0;  ///< total work of corrections
};

Energetic energies(World world, int steps) {
    Running simulation(world);
    Energetic result;
    for (int i = 0; i < steps; ++i) {
        const auto report = simulation.step();
        if (i == 0) result.start = report.kinetic + report.potential - report.energy_change;
        result.rise = std::max(result.rise, report.energy_change - report.lifted);
        result.lifted += report.lifted;
        result.kinetic = report.kinetic;
        result.fastest = std::max(result.fastest, report.kinetic);
    }
    return result;
}

TEST(SimulateHeap, EnergyDecreasesExceptForTheWorkOfCorrections) {
    const auto heaped = energies(heap({0.5, 0}), 450);
    EXPECT_LT(heaped.rise, 1e-4 * heaped.start);
    EXPECT_LT(heaped.kinetic, 0.02 * heaped.fastest);
    EXPECT_GT(heaped.lifted, 0);
    EXPECT_LT(heaped.lifted, 0.1 * heaped.start);
}

/// Kinetic energy in J of the second node, whose inertia tensor is diagonal.
double kinetic(const simulate::Problem& problem) {
    const auto& node = problem.nodes[1];
    double sum = 0.5 * node.velocity.squaredNorm() / node.inverse_mass;
    for (int i = 0; i < 3; ++i) sum += 0.5 * node.spin[i] * node.spin[i] / node.inverse_inertia(i, i);
    return sum;
}

/// A long body lands on its end and slides: friction rotates it, and Newton's law restores the end's speed at
/// any cost in energy.
simulate::Problem falling_rod(Random& random) {
    simulate::Problem problem;
    problem.nodes.resize(2);
    auto& node = problem.nodes[1];
    node.velocity = {random.uniform(-3, 3), -1, 0};
    node.spin = {0, 0, random.uniform(-3, 3)};
    node.inverse_mass = 1;
    node.inverse_inertia = Eigen::Vector3d(12, 12, 12).asDiagonal();
    problem.rows = {unit_test::row_between({0, 0, 0}, {random.uniform(-0.5, 0.5), -0.3, 0}, 1)};
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
        if (newton.rows[0].bounce >= 0) continue; // already separating
        auto bounded = newton;
        const double before = kinetic(newton);
        simulate::solve(newton, settings, 1);
        const auto report = simulate::solve_bounded(bounded, settings, 1);
        EXPECT_TRUE(report.converged);
        gains += kinetic(newton) > 1.01 * before;
        EXPECT_LT(kinetic(bounded), 1.002 * before + 1e-9) << i;
        if (kinetic(newton) > before) continue;
        ++kept;
        // Newton's impulse, where it loses energy
        EXPECT_EQ(bounded.rows[0].impulse, newton.rows[0].impulse) << i;
    }
    EXPECT_GT(gains, 10);
    EXPECT_GT(kept, 10);
}

} // namespace
} // namespace tandem
