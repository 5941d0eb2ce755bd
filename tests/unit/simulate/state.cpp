// SPDX-License-Identifier: MIT
#include "base/error.h"
#include "scenes/motion.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"
#include "tests/unit/simulate/support.h"

namespace tandem {
namespace {

using namespace unit_test;

/// Rigid, fixed and deformable bodies in contact.
World mixed() {
    World world({0.4, 0.3});
    world.dynamics.stepping.step = 0.002;
    world.dynamics.solver.warm_start = true;
    world.add(box({6, 1, 6}), at(0, -0.5, 0), true);
    world.add(box({1, 1, 1}), {turn({0, 0, 1}, 0.3), {0, 0.8, 0}});
    world.add(box({1, 1, 1}), at(0.4, 1.9, 0.2));
    Elastic elastic;
    elastic.young = 2e5;
    elastic.poisson = 0.3;
    elastic.damping = 100;
    auto mesh = beam({1, 0.5, 0.5}, {2, 1, 1});
    for (auto& v : mesh.vertices) v += Eigen::Vector3d(-0.2, 2.5, -0.2);
    world.add_soft(std::move(mesh), elastic);
    return world;
}

std::vector<std::byte> after(Simulation& simulation, const Detect& detect, int steps) {
    for (int i = 0; i < steps; ++i) simulation.step(detect);
    return simulation.state();
}

std::string refusal_of(World world) {
    return support::message_of([&] { const Simulation simulation(world.finish()); });
}

TEST(SimulateState, TwoRunsHaveTheSameBits) {
    auto world = mixed();
    const auto& scene = world.finish();
    const auto detect = detector(scene);
    Simulation a(scene), b(scene);
    const auto end = after(a, detect, 300);
    EXPECT_EQ(end, after(b, detect, 300));
    EXPECT_EQ(a.steps_done(), 300u);
    EXPECT_LT(a.frame().poses[2].translation.y(), 1.9);
}

TEST(SimulateState, RestoredRunContinuesWithTheSameBits) {
    for (const double tolerance : {0.0, 1e-5}) {
        auto world = mixed();
        world.dynamics.stepping.adaptive_tolerance = tolerance;
        world.dynamics.stepping.post_stabilize = world.dynamics.stepping.pre_stabilize = true;
        const auto& scene = world.finish();
        const auto detect = detector(scene);
        Simulation whole(scene), continued(scene);
        auto middle = after(whole, detect, 300);
        while (whole.step(detect).kept == 0) {} // until there are impulses to start from
        middle = whole.state();
        const auto done = whole.steps_done();
        const auto end = after(whole, detect, 50);
        continued.restore(middle);
        EXPECT_EQ(continued.steps_done(), done);
        EXPECT_EQ(after(continued, detect, 50), end);
        whole.restore(middle);
        EXPECT_EQ(after(whole, detect, 50), end);
    }
}

TEST(SimulateState, EnergyChangesSumUpAlsoAfterRestore) {
    auto world = mixed();
    const auto& scene = world.finish();
    const auto detect = detector(scene);
    Simulation whole(scene), continued(scene);
    double sum = 0;
    const auto first = whole.step(detect);
    const double start = first.kinetic + first.potential + first.elastic - first.energy_change;
    // of the two boxes of 2000 kg; the beam of 500 kg is at its build position
    const double heights = 0.8 + 1.9;
    EXPECT_NEAR(start, 9.82 * (2000 * heights + 500 * 2.75), 1e-6);
    for (int i = 0; i < 200; ++i) whole.step(detect);
    continued.restore(whole.state());
    auto before = whole.step(detect);
    EXPECT_EQ(continued.step(detect).energy_change, before.energy_change);
    for (int i = 0; i < 50; ++i) {
        const auto after = whole.step(detect);
        sum = (after.kinetic - before.kinetic) + (after.potential - before.potential)
              + (after.elastic - before.elastic);
        EXPECT_NEAR(after.energy_change, sum, 1e-9 * start);
        before = after;
    }
}

TEST(SimulateState, WarmStartSavesIterations) {
    std::size_t iterations[2] = {0, 0};
    for (const bool warm : {false, true}) {
        World world({0.5, 0});
        world.dynamics.solver.warm_start = warm;
        world.add(box({6, 1, 6}), at(0, -0.5, 0), true);
        for (int i = 0; i < 3; ++i) world.add(box({1, 1, 1}), at(0.1 * i, 0.4999 + 0.9999 * i, 0));
        Running simulation(world, least_translation);
        for (int i = 0; i < 20; ++i) iterations[warm] += simulation.step().iterations;
    }
    EXPECT_LT(2 * iterations[1], iterations[0]);
}

TEST(SimulateState, InvalidStatesAreRefused) {
    auto world = mixed();
    const auto& scene = world.finish();
    Simulation simulation(scene);
    const auto whole = after(simulation, detector(scene), 200);
    for (const std::size_t size : {std::size_t{0}, std::size_t{9}, whole.size() / 2, whole.size() - 1})
        EXPECT_THROW(simulation.restore(std::span(whole).first(size)), InputError) << size;
    auto longer = whole;
    longer.push_back(std::byte{0});
    EXPECT_THROW(simulation.restore(longer), InputError);
    auto other = whole;
    other[0] ^= std::byte{1};
    EXPECT_THROW(simulation.restore(other), InputError);
    EXPECT_EQ(simulation.state(), whole); // a failed restore changes nothing
    auto digested = mixed();
    digested.scene.digest = 7;
    Simulation other_simulation(digested.finish());
    EXPECT_THROW(other_simulation.restore(whole), InputError);
}

TEST(SimulateState, StartIsThatOfTheScene) {
    auto world = mixed();
    const auto& scene = world.finish();
    const Simulation simulation(scene);
    const auto frame = simulation.frame();
    for (std::size_t i = 0; i < frame.poses.size(); ++i) {
        EXPECT_EQ(frame.poses[i].translation, world.start.poses[i].translation);
        EXPECT_EQ(frame.poses[i].rotation.coeffs(), world.start.poses[i].rotation.coeffs());
    }
    EXPECT_EQ(frame.deformed[3], world.start.deformed[3]);
    EXPECT_EQ(simulation.midway().deformed[3], world.start.deformed[3]);
}

TEST(SimulateState, MidwayIsTheFrameOfDetection) {
    auto world = mixed();
    Simulation simulation(world.finish());
    Frame seen;
    simulation.step([&](const Frame& frame, std::vector<ContactPoint>&) { seen = frame; });
    EXPECT_EQ(seen.poses[1].translation, simulation.midway().poses[1].translation);
    EXPECT_EQ(seen.deformed[3], simulation.midway().deformed[3]);
    EXPECT_EQ(seen.poses[3].translation, Eigen::Vector3d::Zero());
    EXPECT_EQ(seen.poses[0].translation, world.start.poses[0].translation);
}

TEST(SimulateState, ImpossibleDynamicsAreRefusedByName) {
    using testing::HasSubstr;
    auto world = mixed();
    EXPECT_EQ(refusal_of(world), "no error");
    world.dynamics.stepping.step = 0;
    EXPECT_THAT(refusal_of(world), HasSubstr("time step of 0"));
    world.dynamics.stepping.step = -0.01;
    EXPECT_THAT(refusal_of(world), HasSubstr("-0.01"));
    world = mixed();
    world.dynamics.bodies.pop_back();
    EXPECT_THAT(refusal_of(world), HasSubstr("4 bodies, but dynamics of 3"));
    world = mixed();
    world.dynamics.bodies[2].material = 9;
    EXPECT_THAT(refusal_of(world), HasSubstr("body 2 has material 9"));
    world = mixed();
    world.dynamics.bodies[3].elastic = -1;
    EXPECT_THAT(refusal_of(world), HasSubstr("body 3"));
    world = mixed();
    world.dynamics.elastics[0].pinned = {1000};
    EXPECT_THAT(refusal_of(world), HasSubstr("pinned vertex 1000"));
    world = mixed();
    world.dynamics.materials.densities[0] = 0;
    EXPECT_THAT(refusal_of(world), HasSubstr("density"));
    world = mixed();
    world.dynamics.materials.surfaces.clear();
    EXPECT_THAT(refusal_of(world), HasSubstr("has no surface for materials"));
    world = mixed();
    world.dynamics.materials.surfaces[{0, 9}] = {};
    EXPECT_THAT(refusal_of(world), HasSubstr("surface of material 9"));
    world = mixed();
    world.dynamics.bodies[1].spin.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal_of(world), HasSubstr("body 1"));
    Scene scripted;
    EXPECT_THROW(Simulation{scripted}, InputError);
}

TEST(SimulateState, ContactsOutOfOrderOrImpossibleAreRefused) {
    auto world = mixed();
    Simulation simulation(world.finish());
    ContactPoint contact{{0, 0, 1, 0}, 0, {0, 0, 0}, {0, 1, 0}, -1e-3};
    const auto refused = [&](std::vector<ContactPoint> given) {
        EXPECT_THROW(
            simulation.step([&](const Frame&, std::vector<ContactPoint>& contacts) { contacts = given; }),
            InputError);
        EXPECT_EQ(simulation.steps_done(), 0u);
    };
    auto other = contact;
    other.pair.body_b = 2;
    refused({other, contact});
    other.pair.body_b = 99;
    refused({other});
    other = contact;
    other.pair.tet_a = 12;
    refused({other});
    other = contact;
    other.normal = {0, 0.5, 0};
    refused({other});
    other = contact;
    other.point[2] = std::numeric_limits<double>::infinity();
    refused({other});
}

/// The error that stops a block of Young's modulus `young`, clamped at two vertices, beside a box of
/// `velocity`.
std::string end_of(double young, double velocity) {
    World world;
    Elastic stiff;
    stiff.young = young;
    stiff.poisson = 0.3;
    stiff.pinned = {0, 1};
    BodyDynamics moves;
    moves.velocity.x() = velocity;
    world.add(box({1, 1, 1}), at(5, 0, 0), false, moves);
    world.add_soft(beam({1, 1, 1}, {1, 1, 1}), stiff);
    Simulation simulation(world.finish());
    return support::message_of([&] {
        for (int i = 0; i < 20; ++i) simulation.step(no_contacts);
    });
}

TEST(SimulateState, DivergenceNamesStepBodyAndValues) {
    using testing::ContainsRegex;
    EXPECT_EQ(end_of(1e3, 1), "no error");
    EXPECT_THAT(end_of(1e12, 1),
                ContainsRegex("diverges in step [0-9]+: body 1 .*kinetic energy of [0-9].*above the limit"));
    EXPECT_THAT(end_of(1e3, 1e200), ContainsRegex("diverges in step 0: body 0 .*not finite.*shorter step"));
}

} // namespace
} // namespace tandem
