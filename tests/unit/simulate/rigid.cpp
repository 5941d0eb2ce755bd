// SPDX-License-Identifier: MIT
#include "scenes/motion.h"
#include "base/random.h"
#include "scenes/simulate/step.h"
#include "tests/support/test.h"
#include "tests/unit/simulate/support.h"

namespace tandem {
namespace {

using namespace unit_test;

/// Momenta of all bodies; the angular one about the origin.
struct Momenta {
    Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
};

Momenta momenta(const simulate::Model& model, const simulate::MotionState& motion) {
    Momenta sum;
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        const auto& state = motion.rigid[i];
        const Eigen::Vector3d linear = model.bodies[i].mass.mass * state.velocity;
        sum.linear += linear;
        sum.angular += state.angular + state.centre.cross(linear);
    }
    return sum;
}

World tumbling() {
    World world({0.4, 0.6});
    Random random(5);
    world.dynamics.gravity.setZero();
    world.dynamics.stepping.post_stabilize = false; // it moves centres without an impulse
    for (int i = 0; i < 6; ++i) {
        const Eigen::Vector3d position(i % 3 * 1.5, i / 3 * 1.5, 0.2 * i);
        BodyDynamics moves;
        moves.velocity = 2 * (Eigen::Vector3d(1.5, 0.75, 0.5) - position) + random.direction();
        moves.spin = 3 * random.direction();
        world.add(box({1, 0.8, 0.6}, {0.3, 0, 0}), {random.rotation(), position}, false, moves);
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

TEST(SimulateRigid, DampingFollowsItsFormula) {
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

TEST(SimulateRigid, MomentaAreConservedInCollisions) {
    auto world = tumbling();
    const auto& scene = world.finish();
    const auto model = simulate::make_model(scene);
    auto motion = simulate::starting_motion(model);
    const auto detect = detector(scene);
    const auto first = momenta(model, motion);
    std::size_t contacts = 0;
    for (std::size_t i = 0; i < 500; ++i) {
        auto outcome = simulate::advance(model, motion, 0.01, i, detect);
        contacts += outcome.report.kept;
        motion = std::move(outcome.end);
    }
    const auto last = momenta(model, motion);
    EXPECT_GT(contacts, 100u);
    EXPECT_LT((last.linear - first.linear).norm(), 1e-6 * first.linear.norm());
    EXPECT_LT((last.angular - first.angular).norm(), 1e-6 * first.angular.norm());
    EXPECT_GT((motion.rigid[0].angular - simulate::starting_motion(model).rigid[0].angular).norm(), 1);
}

TEST(SimulateRigid, MomentumEqualsThatOfTheObservedMotion) {
    auto world = tumbling();
    Simulation simulation(world.finish());
    simulation.step(no_contacts);
    const auto& start = world.start.poses[2];
    const auto end = simulation.frame().poses[2];
    const auto& moves = world.dynamics.bodies[2];
    const Eigen::AngleAxisd turn(end.rotation * start.rotation.conjugate());
    EXPECT_LT((turn.axis() * turn.angle() / 0.01 - moves.spin).norm(), 0.05);
    const Eigen::Vector3d centre(0.3, 0, 0); // centre of mass, away from the mesh's origin
    const Eigen::Vector3d path =
        end.rotation * centre + end.translation - start.rotation * centre - start.translation;
    EXPECT_LT((path / 0.01 - moves.velocity).norm(), 1e-9);
}

TEST(SimulateRigid, FreeSpinAlmostConservesEnergy) {
    World world;
    BodyDynamics moves;
    moves.spin = {0.01, 5, 0}; // about the intermediate axis, which flips repeatedly
    world.add(box({1, 0.6, 0.3}), at(0, 0, 0), false, moves);
    world.dynamics.gravity.setZero();
    world.dynamics.stepping.angular_damping = 0;
    Simulation simulation(world.finish());
    const double start = simulation.step(no_contacts).kinetic;
    EXPECT_NEAR(start, 0.5 * 360 * (1 + 0.3 * 0.3) / 12 * 25, 0.01); // m (a^2 + c^2) / 12, 5 rad/s
    for (int i = 0; i < 2000; ++i) ASSERT_NEAR(simulation.step(no_contacts).kinetic, start, 0.001 * start);
}

} // namespace
} // namespace tandem
