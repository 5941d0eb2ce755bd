// SPDX-License-Identifier: MIT
#include "scenes/motion.h"
#include "scenes/simulate/stabilize.h"
#include "tests/support/test.h"
#include "tests/unit/simulate/support.h"

namespace tandem {
namespace {

using namespace unit_test;

// Motions with known results under default settings: within 2 % of each. A bounce or stop can be early or
// late by half a step's motion, so the tests are sensitive to settings rather than to steps.

constexpr double earth = 9.82, radians = 3.14159265358979323846 / 180, within = 0.02;

/// A box of `side` and `density` on the ground, body 1.
World on_ground(Surface surface, double side = 1, double density = 2000) {
    World world(surface);
    world.dynamics.materials.densities = {density};
    world.add(box({50 * side, side, 50 * side}), at(0, -0.5 * side, 0), true);
    return world;
}

/// Tilts gravity as for a ground that slopes down along x.
void tilt(World& world, double degrees) {
    world.dynamics.gravity = {earth * std::sin(radians * degrees), -earth * std::cos(radians * degrees), 0};
}

struct Ended {
    Eigen::Vector3d position; ///< of body 1
    Eigen::Quaterniond rotation;
    std::size_t iterations = 0, not_converged = 0;
    double deepest = 0; ///< in the last step
};

Ended ended(World& world, int steps, const ContactSettings& contacts = least_translation) {
    Running simulation(world, contacts);
    Ended result;
    for (int i = 0; i < steps; ++i) {
        const auto report = simulation.step();
        result.iterations += report.iterations;
        result.not_converged += !report.converged;
        result.deepest = report.deepest;
    }
    const auto pose = simulation.frame().poses[1];
    result.position = pose.translation;
    result.rotation = pose.rotation;
    return result;
}

/// Gravity and friction cancel to a hundredth: 1/2 g (sin - mu cos) t^2, independent of the block's mass.
TEST(SimulateDefaults, BlockSlidesDownASlightSlope) {
    for (const auto& [side, density] : {std::pair(1.0, 2000.0), {0.02, 1.0}, {30.0, 8000.0}}) {
        auto world = on_ground({0.5, 0}, side, density);
        tilt(world, 27);
        world.add(box({side, side, side}), at(0, (0.5 - 1e-4) * side, 0));
        const auto end = ended(world, 200);
        const double expected = 0.5 * earth * (std::sin(27 * radians) - 0.5 * std::cos(27 * radians)) * 2 * 2;
        EXPECT_NEAR(end.position.x(), expected, within * expected) << side;
        EXPECT_EQ(end.not_converged, 0u) << side;
        EXPECT_LT(end.iterations, 200u * 30) << side;
    }
}

/// Relative excess of the distance that a block slides down a slight slope. It starts `sunk` of its size deep
/// in a ground 100 times as wide.
double excess_distance(double side, bool ground_first, double sunk = 0, const StepSettings& stepping = {}) {
    World world({0.5, 0});
    world.dynamics.stepping = stepping;
    tilt(world, 27);
    const auto add_ground = [&] { world.add(box({100 * side, 1, 100 * side}), at(0, -0.5, 0), true); };
    if (ground_first) add_ground();
    world.add(box({side, side, side}), at(0, (0.5 - sunk) * side, 0));
    if (!ground_first) add_ground();
    Running simulation(world, least_translation);
    for (int i = 0; i < 200; ++i) simulation.step();
    const double expected = 0.5 * earth * (std::sin(27 * radians) - 0.5 * std::cos(27 * radians)) * 2 * 2;
    return simulation.frame().poses[ground_first ? 1 : 0].translation.x() / expected - 1;
}

TEST(SimulateDefaults, BlockOfAnySizeSlidesWhicheverBodyIsFirst) {
    for (const double side : {0.05, 0.125, 0.3, 0.5, 1.0, 20.0})
        for (const bool ground_first : {true, false})
            EXPECT_NEAR(excess_distance(side, ground_first), 0, within) << side << " " << ground_first;
}

/// The purpose of each of the two settings.
TEST(SimulateDefaults, WithoutSurfaceNormalsOrALayerItSticksOrSlidesTooFar) {
    for (const double sunk : {1e-4, 1e-3}) {
        EXPECT_LT(excess_distance(1, true, sunk, {.surface_normals = false}), -0.9);
        EXPECT_NEAR(excess_distance(1, true, sunk), 0, within);
    }
    double farthest = 0;
    for (const double side : {0.05, 0.125, 0.3, 0.5, 1.0, 20.0})
        farthest = std::max(farthest, std::fabs(excess_distance(side, true, 0, {.contact_layer = 0})));
    EXPECT_GT(farthest, 0.05);
}

/// The block sinks by the layer, and all its corners stay in contact.
TEST(SimulateDefaults, BlockSettlesInTheLayerAndKeepsItsCorners) {
    for (const double side : {0.01, 0.1, 1.0, 10.0}) {
        World world({0.5, 0});
        world.add(box({20 * side, 1, 20 * side}), at(0, -0.5, 0), true);
        world.add(box({side, side, side}), at(0, 0.5 * side, 0));
        Running simulation(world, least_translation);
        const auto& scene = world.scene;
        for (int i = 0; i < 100; ++i) EXPECT_GE(simulation.step().kept, 4u);
        const double layer = simulate::layer_of(simulate::make_model(scene), {0, 0, 1, 0}, 0.01);
        EXPECT_GE(layer, world.dynamics.stepping.contact_layer * side);
        EXPECT_LE(layer, 0.5 * simulate::tolerated_gap * side);
        const double sunk = 0.5 * side - simulation.frame().poses[1].translation.y();
        EXPECT_TRUE(sunk > 0.99 * layer && sunk < 1.6 * layer) << sunk << " " << layer;
    }
    EXPECT_EQ(simulate::settling(0, 1, 0.1), simulate::settling(-0.999, 1, 0.1)); // one speed for all
    EXPECT_GT(simulate::settling(0, 1, 0.1), 0);
    EXPECT_EQ(simulate::settling(-1.001, 1, 0.1), 0);
}

TEST(SimulateDefaults, BlockStaysOnASlopeThatIsNotSteepEnough) {
    auto world = on_ground({0.5, 0});
    tilt(world, 26);
    world.add(box({1, 1, 1}), at(0, 0.5, 0));
    EXPECT_LT(std::fabs(ended(world, 300).position.x()), 1e-3);
}

/// v^2 / (2 mu g), corrected for the step in which it stops: at the remaining speed r, it moves r h / 2
/// instead of r^2 / (2 mu g).
TEST(SimulateDefaults, BlockStopsAfterTheCoulombDistance) {
    for (const double friction : {0.2, 0.5}) {
        auto world = on_ground({friction, 0});
        BodyDynamics moves;
        moves.velocity = {2, 0, 0};
        world.add(box({1, 1, 1}), at(0, 0.5, 0), false, moves);
        const double slowed = friction * earth * 0.01;
        const double rest = std::fmod(2, slowed);
        const double expected = (4 - rest * rest) / (2 * friction * earth) + 0.5 * 0.01 * rest;
        EXPECT_NEAR(expected, 4 / (2 * friction * earth), 1e-3);
        EXPECT_NEAR(ended(world, 200).position.x(), expected, 0.002 * expected) << friction;
    }
}

TEST(SimulateDefaults, FreeMotionIsNotDamped) {
    World world;
    world.add(box({1, 1, 1}), at(0, 0, 0), true);
    BodyDynamics moves;
    moves.velocity = {7, 0, 0};
    moves.spin = {0, 3, 0};
    world.add(box({1, 1, 1}), at(5, 0, 0), false, moves);
    const auto end = ended(world, 1000);
    EXPECT_NEAR(end.position.x(), 5 + 70, 1e-9);
    EXPECT_NEAR(end.position.y(), -0.5 * earth * 100, 1e-8);
    EXPECT_NEAR(std::fabs(end.rotation.dot(turn({0, 1, 0}, 30))), 1, 1e-4);
}

/// The initial penetration is reduced to the tolerance of the settings.
TEST(SimulateDefaults, BodiesThatDoNotBounceEndOnTheGround) {
    for (const double side : {0.1, 1.0}) {
        auto world = on_ground({0.5, 0}, side);
        world.add(box({side, side, side}), at(0, 1.5 * side, 0));
        const auto end = ended(world, 200);
        EXPECT_LT(end.deepest, 1.01 * simulate::tolerated_gap * side);
        EXPECT_NEAR(end.position.y(), 0.5 * side, 1.01 * simulate::tolerated_gap * side);
    }
}

TEST(SimulateDefaults, BounceKeepsTheSquareOfRestitution) {
    auto world = on_ground({0.5, 0.6});
    world.add(box({1, 1, 1}), at(0, 1.5, 0));
    Running simulation(world, least_translation);
    double before = 0;
    for (int i = 0; i < 60; ++i) {
        const auto report = simulation.step();
        if (report.found > 0) {
            EXPECT_NEAR(report.kinetic, 0.36 * before, within * 0.36 * before);
            return;
        }
        before = report.kinetic;
    }
    FAIL() << "the body does not land";
}

/// Without gravity, tolerances are relative to the initial speed.
TEST(SimulateDefaults, EqualBallsSwapTheirVelocities) {
    World world({0, 1});
    world.dynamics.gravity.setZero();
    BodyDynamics moves;
    moves.velocity = {3, 0, 0};
    world.add(ball(0.5, 1), at(-1.2, 0, 0), false, moves);
    world.add(ball(0.5, 1), at(0.2, 0, 0));
    const auto end = ended(world, 100, {});
    const double collision_time = (1.4 - 1) / 3; // s
    EXPECT_NEAR(end.position.x(), 0.2 + 3 * (1 - collision_time), within * 3);
    EXPECT_EQ(end.not_converged, 0u);
}

/// A pillar half as wide as high tips over beyond an angle whose tangent is a half.
TEST(SimulateDefaults, PillarStandsOnASlopeUnlessItIsTooSteep) {
    for (const double degrees : {25.0, 28.0}) {
        auto world = on_ground({2, 0});
        tilt(world, degrees);
        world.add(box({0.5, 1, 0.5}), at(0, 0.5, 0));
        const auto end = ended(world, 200);
        const double tipped = 2 * std::acos(std::min(1.0, std::fabs(end.rotation.w())));
        EXPECT_EQ(tipped > 0.5, degrees > 26.6) << degrees << " " << tipped;
        if (degrees < 26) {
            EXPECT_LT(end.position.x(), 0.01);
        }
    }
}

TEST(SimulateDefaults, StackStaysAtRest) {
    auto world = on_ground({0.5, 0});
    for (int i = 0; i < 5; ++i) world.add(box({1, 1, 1}), at(0, 0.5 + i, 0));
    Running simulation(world, least_translation);
    for (int i = 0; i < 200; ++i) simulation.step();
    const auto frame = simulation.frame();
    for (std::size_t i = 1; i < frame.poses.size(); ++i)
        EXPECT_LT((frame.poses[i].translation - world.start.poses[i].translation).norm(), 0.005) << i;
}

} // namespace
} // namespace tandem
