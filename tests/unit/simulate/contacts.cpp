// SPDX-License-Identifier: MIT
#include "scenes/motion.h"
#include "tests/support/test.h"
#include "tests/unit/simulate/support.h"

namespace tandem {
namespace {

using namespace unit_test;

constexpr double pi = 3.14159265358979323846;

/// Solved almost exactly, so tests measure the model and not the tolerance.
World exact_world(Surface surface) {
    World world(surface);
    world.dynamics.solver.iterations = 2000;
    world.dynamics.solver.absolute_tolerance = 1e-9;
    world.dynamics.solver.relative_tolerance = 0;
    world.dynamics.stepping.contact_layer = 0;
    world.dynamics.stepping.linear_damping = world.dynamics.stepping.angular_damping = 0;
    return world;
}

void add_ground(World& world, double size = 20) { world.add(box({size, 1, size}), at(0, -0.5, 0), true); }

class Resting : public testing::TestWithParam<SolverSettings::Method> {};

TEST_P(Resting, BoxStaysInPlace) {
    auto world = exact_world({0.5, 0.3});
    world.dynamics.solver.method = GetParam();
    add_ground(world);
    world.add(box({1, 1, 1}), at(0.1, 0.5 - 1e-4, 0.2));
    Running simulation(world);
    for (int i = 0; i < 500; ++i) simulation.step();
    const auto pose = simulation.frame().poses[1];
    EXPECT_LT((pose.translation - world.start.poses[1].translation).norm(), 1e-3);
    EXPECT_LT(pose.rotation.vec().norm(), 1e-3);
}

TEST_P(Resting, BlockSlidesTheCoulombDistance) {
    auto world = exact_world({0.3, 0});
    world.dynamics.solver.method = GetParam();
    world.dynamics.stepping.step = 0.002;
    add_ground(world);
    BodyDynamics moves;
    moves.velocity = {2, 0, 1};
    world.add(box({1, 0.4, 1}), at(0, 0.2 - 1e-4, 0), false, moves);
    Running simulation(world);
    for (int i = 0; i < 500; ++i) simulation.step();
    const double expected = 5 / (2 * 0.3 * 9.82); // v^2 / (2 mu g)
    Eigen::Vector3d path = simulation.frame().poses[1].translation;
    path.y() = 0;
    EXPECT_NEAR(path.norm(), expected, 0.02 * expected);
    EXPECT_NEAR(path.x(), 2 * path.z(), 0.02 * expected);
}

INSTANTIATE_TEST_SUITE_P(SimulateContacts, Resting,
                         testing::Values(SolverSettings::Method::gauss_seidel,
                                         SolverSettings::Method::jacobi));

/// Ratio of rebound height to drop height.
double rebound(Mesh mesh, double lowest, double restitution) {
    auto world = exact_world({0, restitution});
    world.dynamics.stepping.step = 0.0005;
    add_ground(world, 4);
    const double drop = 0.5;
    world.add(std::move(mesh), at(0, drop - lowest, 0));
    Running simulation(world);
    double highest = 0;
    bool touched = false;
    for (int i = 0; i < 1200; ++i) {
        touched = simulation.step().found > 0 || touched;
        if (touched) highest = std::max(highest, simulation.frame().poses[1].translation.y() + lowest);
    }
    return highest / drop;
}

TEST(SimulateContacts, BoxAndBallReboundByTheSquareOfRestitution) {
    EXPECT_NEAR(rebound(box({0.4, 0.4, 0.4}), -0.2, 0.6), 0.36, 0.36 * 0.04);
    EXPECT_NEAR(rebound(box({0.4, 0.4, 0.4}), -0.2, 0), 0, 0.01);
    auto sphere = ball(0.2, 2);
    double lowest = 0;
    for (const auto& v : sphere.vertices) lowest = std::min(lowest, v.y());
    EXPECT_NEAR(rebound(std::move(sphere), lowest, 0.6), 0.36, 0.36 * 0.04);
}

TEST(SimulateContacts, BounceCanBeSwitchedOff) {
    auto world = exact_world({0, 0.8});
    world.dynamics.stepping.bounce = false;
    add_ground(world, 4);
    BodyDynamics moves;
    moves.velocity = {0, -3, 0};
    world.add(box({1, 1, 1}), at(0, 0.5, 0), false, moves);
    const auto& scene = world.finish();
    Simulation simulation(scene);
    EXPECT_NEAR(simulation.step(detector(scene)).kinetic, 0, 1e-6);
}

/// Penetration and kinetic energy per step of a box placed 0.05 of its size deep in the ground.
std::vector<StepReport> sunk(bool pre, bool post) {
    auto world = exact_world({0.5, 0});
    world.dynamics.stepping.pre_stabilize = pre;
    world.dynamics.stepping.post_stabilize = post;
    add_ground(world);
    world.add(box({1, 1, 1}), at(0, 0.45, 0));
    Running simulation(world);
    std::vector<StepReport> reports;
    for (int i = 0; i < 60; ++i) reports.push_back(simulation.step());
    return reports;
}

TEST(SimulateContacts, StabilisationRemovesPenetration) {
    const auto none = sunk(false, false);
    EXPECT_NEAR(none.back().deepest, 0.05, 1e-4);
    for (const bool pre : {false, true}) {
        const auto reports = sunk(pre, !pre);
        EXPECT_LT(reports.back().deepest, 0.002);
        EXPECT_GT(reports[1].deepest, 0.039);   // at most a hundredth of the size per step
        EXPECT_EQ(reports[1].kinetic > 1, pre); // positions are corrected without velocity
        EXPECT_LT(reports.back().kinetic, 1);
    }
}

TEST(SimulateContacts, PillarStands) {
    auto world = exact_world({0.65, 0.7});
    world.dynamics.solver.iterations = 300;
    add_ground(world);
    for (int i = 0; i < 5; ++i) world.add(box({1, 1, 1}), at(0, 0.5 - 1e-4 + (1 - 1e-4) * i, 0));
    Running simulation(world);
    for (int i = 0; i < 200; ++i) simulation.step();
    const auto pose = simulation.frame().poses[5];
    EXPECT_LT((pose.translation - world.start.poses[5].translation).norm(), 0.01);
}

/// Half a ring of seven wedges on a fixed ground; the outermost two stand on it.
World arch(bool keystone) {
    auto world = exact_world({0.65, 0});
    world.dynamics.solver.iterations = 300;
    add_ground(world);
    constexpr int stones = 7;
    const double inner = 2, outer = 3, sunk = 1e-4;
    for (int i = 0; i < stones; ++i) {
        if (i == stones / 2 && !keystone) continue;
        const double overlap = 1e-5;
        std::array<Eigen::Vector3d, 8> corners;
        for (std::size_t c = 0; c < 8; ++c) {
            const double angle = pi * (i + (c & 1 ? 1 : 0)) / stones + (c & 1 ? overlap : -overlap);
            const double radius = c & 2 ? outer : inner;
            corners[c] = {radius * std::cos(angle), radius * std::sin(angle) - sunk, c & 4 ? 0.5 : -0.5};
        }
        world.add(hexahedron(corners), {});
    }
    return world;
}

/// Largest displacement of a stone's centre after 150 steps.
double fallen(World world) {
    Running simulation(world);
    const auto& scene = world.scene;
    for (int i = 0; i < 150; ++i) simulation.step();
    const auto frame = simulation.frame();
    double most = 0;
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
        const auto& middle = scene.meshes[i].vertices.back();
        const auto& pose = frame.poses[i];
        most = std::max(most, (rotated(pose.rotation, middle) + pose.translation - middle).norm());
    }
    return most;
}

TEST(SimulateContacts, ArchNeedsItsKeystone) {
    EXPECT_LT(fallen(arch(true)), 0.02);
    EXPECT_GT(fallen(arch(false)), 0.5);
}

} // namespace
} // namespace tandem
