// SPDX-License-Identifier: MIT
#include "tests/support/test.h"
#include "tests/unit/simulate/support.h"

namespace tandem {
namespace {

using namespace unit_test;
using Law = Elastic::Law;

Elastic rubber(Law law = Law::corotational) {
    Elastic elastic;
    elastic.law = law;
    elastic.young = 1e6;
    elastic.poisson = 0.3;
    return elastic;
}

Mesh moved(Mesh mesh, const Eigen::Vector3d& by) {
    for (auto& v : mesh.vertices) v += by;
    return mesh;
}

Eigen::Vector3d mean(const std::vector<Eigen::Vector3d>& points) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& p : points) sum += p;
    return sum / static_cast<double>(points.size());
}

/// A beam along x, clamped at x = 0, that swings under its weight.
World cantilever(Law law) {
    World world;
    world.dynamics.materials.densities[0] = 1000;
    auto mesh = beam({2, 0.5, 0.5}, {8, 2, 2});
    auto elastic = rubber(law);
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i)
        if (mesh.vertices[i].x() == 0) elastic.pinned.push_back(i);
    world.add_soft(std::move(mesh), elastic);
    world.dynamics.stepping.step = 5e-4; // the fastest wave crosses the smallest element in 2e-3 s
    return world;
}

class SimulateSoft : public testing::TestWithParam<Law> {};

TEST_P(SimulateSoft, CantileverKeepsItsEnergy) {
    auto world = cantilever(GetParam());
    Simulation simulation(world.finish());
    const auto pinned = world.dynamics.elastics[0].pinned;
    StepReport report = simulation.step(no_contacts);
    const double start = report.kinetic + report.potential + report.elastic;
    double swing = 0, most = 0;
    for (int i = 1; i < 1000; ++i) {
        report = simulation.step(no_contacts);
        swing = std::max(swing, report.elastic);
        most = std::max(most, std::fabs(report.kinetic + report.potential + report.elastic - start));
    }
    EXPECT_GT(swing, 1);
    EXPECT_LT(most, 0.05 * swing);
    EXPECT_EQ(report.inverted, 0u);
    const auto vertices = simulation.frame().deformed[0];
    for (const auto vertex : pinned) EXPECT_EQ(vertices[vertex], world.start.deformed[0][vertex]);
    EXPECT_EQ(simulation.frame().poses[0].translation, Eigen::Vector3d::Zero());
}

INSTANTIATE_TEST_SUITE_P(Laws, SimulateSoft, testing::Values(Law::corotational, Law::saint_venant_kirchhoff));

TEST(SimulateSoftContacts, ActOnlyWhenCoupled) {
    for (const bool couple : {true, false}) {
        World world({0.5, 0});
        world.dynamics.stepping.step = 1e-3;
        world.dynamics.stepping.couple_contacts = couple;
        world.add(box({4, 1, 4}), at(0, -0.5, 0), true);
        auto elastic = rubber();
        elastic.damping = 2000;
        world.add_soft(moved(beam({1, 0.5, 1}, {2, 1, 2}), {-0.5, 0.02, -0.5}), elastic);
        Running simulation(world);
        std::size_t found = 0;
        for (int i = 0; i < 600; ++i) found += simulation.step().found;
        EXPECT_GT(found, 100u);
        const double height = mean(simulation.frame().deformed[1]).y();
        if (couple)
            EXPECT_NEAR(height, 0.25, 0.02);
        else
            EXPECT_LT(height, -0.3);
    }
}

TEST(SimulateSoftContacts, RigidBodyRestsOnADeformableOne) {
    World world({0.5, 0});
    world.dynamics.stepping.step = 1e-3;
    auto elastic = rubber();
    elastic.damping = 20000;
    auto mesh = beam({1, 0.5, 1}, {2, 1, 2});
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i)
        if (mesh.vertices[i].y() == 0) elastic.pinned.push_back(i);
    world.add_soft(std::move(mesh), elastic);
    world.add(box({0.6, 0.4, 0.6}), at(0.5, 0.7, 0.5));
    Running simulation(world);
    StepReport report;
    for (int i = 0; i < 1000; ++i) report = simulation.step();
    EXPECT_NEAR(simulation.frame().poses[1].translation.y(), 0.7, 0.02);
    EXPECT_LT(report.kinetic, 0.1);
    EXPECT_GT(report.elastic, 0.01);
}

TEST(SimulateSoftContacts, CollisionsKeepMomentum) {
    World world({0.3, 0.5});
    world.dynamics.gravity.setZero();
    world.dynamics.stepping.step = 1e-3;
    world.dynamics.stepping.linear_damping = 0;
    BodyDynamics moves;
    moves.velocity = {2, 0.3, 0};
    moves.spin = {0, 0, 1};
    world.add_soft(beam({1, 0.5, 0.5}, {2, 1, 1}), rubber(), moves);
    world.add_soft(moved(beam({1, 0.5, 0.5}, {2, 1, 1}), {1.05, 0.1, 0.1}), rubber());
    world.add(box({1, 0.5, 0.5}), at(2.6, 0.3, 0.3));
    Running simulation(world);
    const auto& scene = world.scene;
    std::size_t kept = 0;
    for (int i = 0; i < 300; ++i) kept += simulation.step().kept;
    EXPECT_GT(kept, 10u);
    // All elements of a beam have one volume; velocities of the second half of the last step come from two
    // frames.
    constexpr double corner = 2000 * 0.25 / 12 / 4;
    const auto end = simulation.frame();
    Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
    for (std::size_t body = 0; body < 2; ++body)
        for (const auto& t : scene.meshes[body].tetrahedra)
            for (const auto v : t)
                momentum += corner * (end.deformed[body][v] - simulation.midway().deformed[body][v]) / 5e-4;
    const Eigen::Vector3d rigid =
        2000 * 0.25 * (end.poses[2].translation - simulation.midway().poses[2].translation) / 5e-4;
    EXPECT_GT(rigid.norm(), 10);
    momentum += rigid;
    const Eigen::Vector3d expected = 2000 * 0.25 * moves.velocity;
    EXPECT_LT((momentum - expected).norm(), 1e-6 * expected.norm());
}

TEST(SimulateSoftSteps, AdaptiveStepIsHalvedAndDoubled) {
    auto world = cantilever(Law::corotational);
    world.dynamics.elastics[0].damping = 20000; // comes to rest, so that longer steps pass later on
    world.dynamics.stepping.step = 0.032;
    world.dynamics.stepping.adaptive_tolerance = 1e-6;
    Simulation simulation(world.finish());
    std::size_t detections = 0;
    const auto count = [&](const Frame&, std::vector<ContactPoint>& contacts) {
        ++detections;
        contacts.clear();
    };
    std::vector<double> lengths;
    lengths.push_back(simulation.step(count).length);
    EXPECT_EQ(detections, 3 + 2 * 4u); // one full and two half steps, and two more for each halving
    for (int i = 1; i < 11; ++i) lengths.push_back(simulation.step(count).length);
    EXPECT_EQ(detections, 11 + 10 * 3u);
    lengths.push_back(simulation.step(count).length);
    EXPECT_EQ(detections, 11 + 10 * 3 + 5u); // ten passes: a doubled step was tried and rejected
    for (int i = 12; i < 300; ++i) lengths.push_back(simulation.step(count).length);
    EXPECT_EQ(lengths.front(), 0.002); // halved four times
    const auto longer = std::find(lengths.begin(), lengths.end(), 0.004);
    ASSERT_NE(longer, lengths.end());
    for (std::size_t i = 1; i < lengths.size(); ++i) // doubled after at least ten passes
        if (lengths[i] > lengths[i - 1]) {
            ASSERT_GE(i, 10u);
            for (std::size_t j = i - 10; j + 1 < i; ++j) EXPECT_EQ(lengths[j], lengths[i - 1]);
        }
}

TEST(SimulateSoftSteps, RestoredRunDoublesAtTheSameStep) {
    auto world = cantilever(Law::corotational);
    world.dynamics.elastics[0].damping = 20000;
    world.dynamics.stepping.step = 0.032;
    world.dynamics.stepping.adaptive_tolerance = 1e-6;
    const auto& scene = world.finish();
    Simulation whole(scene), continued(scene);
    for (int i = 0; i < 60; ++i) whole.step(no_contacts);
    continued.restore(whole.state());
    bool doubled = false;
    for (int i = 0; i < 30; ++i) {
        const double length = whole.step(no_contacts).length;
        EXPECT_EQ(continued.step(no_contacts).length, length);
        doubled = doubled || length > 0.002;
    }
    EXPECT_TRUE(doubled);
    EXPECT_EQ(continued.state(), whole.state());
}

TEST(SimulateSoftSteps, NoStepIsShorterThanTheLeast) {
    auto world = cantilever(Law::corotational);
    world.dynamics.stepping.step = 1e-3;
    world.dynamics.stepping.adaptive_tolerance = 1e-300;
    world.dynamics.stepping.least_step = 2e-4;
    Simulation simulation(world.finish());
    for (int i = 0; i < 20; ++i) EXPECT_DOUBLE_EQ(simulation.step(no_contacts).length, 2.5e-4);
}

} // namespace
} // namespace tandem
