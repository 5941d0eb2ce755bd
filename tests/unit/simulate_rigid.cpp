// SPDX-License-Identifier: MIT
#include "scenes/motion.h"
#include "scenes/random.h"
#include "scenes/simulate/mass.h"
#include "tests/unit/simulate_support.h"

#include <gtest/gtest.h>

namespace tandem {

namespace {

using namespace test;

/// Momenta of bodies of equal density from two frames half a step apart: the velocity between is constant.
struct Momenta {
    Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
};

/// Linear momentum and momentum about the origin at the end of the last step, from poses alone. The second
/// half step turns at a constant spin, which is the rotation vector between the two poses over time.
Momenta momenta(const World& world, const Frame& middle, const Frame& end, double half) {
    Momenta sum;
    for (std::size_t i = 0; i < world.scene.bodies.size(); ++i) {
        const auto m = mass_properties(world.scene.meshes[i], 2000);
        const auto& a = middle.poses[i];
        const auto& b = end.poses[i];
        const Eigen::Vector3d from = a.rotation * m.centre + a.translation;
        const Eigen::Vector3d to = b.rotation * m.centre + b.translation;
        const Eigen::Vector3d velocity = (to - from) / half;
        const Eigen::AngleAxisd turn(b.rotation * a.rotation.conjugate());
        const Eigen::Vector3d spin = turn.axis() * (turn.angle() / half);
        const Eigen::Matrix3d r = a.rotation.toRotationMatrix();
        sum.linear += m.mass * velocity;
        sum.angular += m.mass * from.cross(velocity) + r * m.inertia * r.transpose() * spin;
    }
    return sum;
}

World tumbling() {
    World world({0.4, 0.6});
    Random random(5);
    world.dynamics.gravity.setZero();
    world.dynamics.stepping.linear_damping = world.dynamics.stepping.angular_damping = 0;
    for (int i = 0; i < 6; ++i) {
        const Eigen::Vector3d place(i % 3 * 1.5, i / 3 * 1.5, 0.2 * i);
        BodyDynamics moves;
        moves.velocity = 2 * (Eigen::Vector3d(1.5, 0.75, 0.5) - place) + random.direction();
        moves.spin = 3 * random.direction();
        world.add(box({1, 0.8, 0.6}, {0.3, 0, 0}), {random.rotation(), place}, false, moves);
    }
    return world;
}

TEST(SimulateRigid, FreeFallIsExact) {
    World world;
    BodyDynamics moves;
    moves.velocity = {1, 2, 3};
    world.add(box({1, 1, 1}, {5, 0, 0}), at(0, 10, 0), false, moves);
    world.dynamics.stepping.linear_damping = world.dynamics.stepping.angular_damping = 0;
    Simulation simulation(world.finish());
    StepReport report;
    for (int i = 0; i < 100; ++i) report = simulation.step(no_contacts);
    EXPECT_NEAR(report.time, 1, 1e-12);
    const Eigen::Vector3d expected(1, 10 + 2 - 9.82 / 2, 3);
    EXPECT_LT((simulation.frame().poses[0].translation - expected).norm(), 1e-10);
    EXPECT_NEAR(report.kinetic, 1000 * (1 + (2 - 9.82) * (2 - 9.82) + 9), 1e-6);
    EXPECT_NEAR(report.kinetic + report.potential, 1000 * 14 + 2000 * 9.82 * 10, 1e-5);
}

TEST(SimulateRigid, DampingIsThatOfTheFormula) {
    World world;
    BodyDynamics moves;
    moves.velocity = {1, 0, 0};
    world.add(box({1, 1, 1}), at(0, 0, 0), false, moves);
    world.dynamics.gravity.setZero();
    world.dynamics.stepping.linear_damping = 0.5;
    Simulation simulation(world.finish());
    StepReport report;
    for (int i = 0; i < 100; ++i) report = simulation.step(no_contacts);
    EXPECT_NEAR(report.kinetic, 1000 * std::exp(-1.0), 1000 * 0.005);
}

TEST(SimulateRigid, MomentaAreKeptThroughCollisions) {
    auto world = tumbling();
    const auto& scene = world.finish();
    Simulation simulation(scene);
    const auto detect = detector(scene);
    simulation.step(detect);
    const double half = world.dynamics.stepping.step / 2;
    const auto first = momenta(world, simulation.midway(), simulation.frame(), half);
    std::size_t contacts = 0;
    for (int i = 1; i < 500; ++i) contacts += simulation.step(detect).kept;
    const auto last = momenta(world, simulation.midway(), simulation.frame(), half);
    EXPECT_GT(contacts, 100u);
    EXPECT_LT((last.linear - first.linear).norm(), 1e-6 * first.linear.norm());
    EXPECT_LT((last.angular - first.angular).norm(), 1e-6 * first.angular.norm());
}

TEST(SimulateRigid, FreeSpinKeepsItsEnergyNearly) {
    World world;
    BodyDynamics moves;
    moves.spin = {0.01, 5, 0}; // about the middle axis, which turns over again and again
    world.add(box({1, 0.6, 0.3}), at(0, 0, 0), false, moves);
    world.dynamics.gravity.setZero();
    world.dynamics.stepping.angular_damping = 0;
    Simulation simulation(world.finish());
    const double start = simulation.step(no_contacts).kinetic;
    for (int i = 0; i < 1000; ++i) {
        const double now = simulation.step(no_contacts).kinetic;
        ASSERT_LT(now, 3 * start);
        ASSERT_GT(now, start / 3);
    }
}

} // namespace

} // namespace tandem
