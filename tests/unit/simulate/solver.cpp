// SPDX-License-Identifier: MIT
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/solve.h"
#include "tests/support/test.h"
#include "tests/unit/simulate/rows.h"
#include "tests/unit/simulate/support.h"

namespace tandem::simulate {
namespace {

using namespace unit_test;

SolverSettings exact(SolverSettings::Method method) {
    return {.method = method, .iterations = 5000, .absolute_tolerance = 1e-10, .relative_tolerance = 0};
}

/// Stacks of boxes in face contact, with more rows than one thread processes.
World stacks(int count, int height) {
    World world({0.5, 0.2});
    world.add(box({100, 1, 100}), at(0, -0.5, 0), true);
    for (int x = 0; x < count; ++x)
        for (int y = 0; y < height; ++y)
            world.add(box({1, 1, 1}), at(-40 + 2.0 * x + 0.02 * y, 0.4999 + 0.9999 * y, 0.03 * y));
    return world;
}

class SimulateSolver : public testing::TestWithParam<SolverSettings::Method> {};

TEST_P(SimulateSolver, CentralImpactSticksOrSlips) {
    for (const double friction : {0.1, 10.0}) {
        Problem problem;
        problem.nodes.resize(2);
        problem.nodes[1] = {.velocity = {3, -2, 0}, .inverse_mass = 0.5};
        problem.rows = {row_between({0, 0, 0}, {0, 0, 0}, friction)};
        solve(problem, exact(GetParam()), 1);
        EXPECT_NEAR(problem.rows[0].impulse.x(), 4, 1e-8); // 2 kg stopped from 2 m/s
        EXPECT_NEAR(problem.nodes[1].velocity.y(), 0, 1e-8);
        EXPECT_NEAR(problem.nodes[1].velocity.x(), friction < 1 ? 3 - 0.5 * 0.1 * 4 : 0, 1e-8);
    }
}

TEST_P(SimulateSolver, SolutionObeysTheContactLaws) {
    auto world = stacks(2, 2);
    for (std::size_t i = 1; i < world.dynamics.bodies.size(); ++i)
        world.dynamics.bodies[i].velocity = {1, 0, 0.3};
    const Beginning start(world);
    const auto& [scene, model, motion, free, contacts] = start;
    auto problem = make_problem(model, motion, free, contacts);
    solve(problem, exact(GetParam()), 1);
    double largest = 0;
    for (const auto& row : problem.rows) {
        const auto velocity = problem.velocity(row);
        const double gap = dot(row.normal, velocity) + row.bias;
        EXPECT_GT(gap, -1e-6);
        EXPECT_GE(row.impulse.x(), 0);
        EXPECT_LT(row.impulse.x() * gap, 1e-5);
        const Eigen::Vector3d slide = velocity - dot(row.normal, velocity) * row.normal;
        const Eigen::Vector3d friction = row.impulse.y() * row.tangent + row.impulse.z() * row.binormal;
        EXPECT_LE(length(friction), row.friction * row.impulse.x() * (1 + 1e-9) + 1e-9);
        if (length(slide) > 1e-3 && row.impulse.x() > 1e-3) {
            EXPECT_NEAR(length(friction), row.friction * row.impulse.x(), 1e-3);
            EXPECT_LT(dot(friction, slide), 0);
        }
        largest = std::max(largest, row.impulse.x());
    }
    EXPECT_GT(largest, 1);
}

TEST_P(SimulateSolver, ReportsWhetherAToleranceEndedIt) {
    auto world = stacks(1, 4);
    Beginning start(world);
    auto& [scene, model, motion, free, contacts] = start;
    const auto ended = [&](SolverSettings settings) {
        auto problem = make_problem(model, motion, free, contacts);
        settings.method = GetParam();
        return solve(problem, settings, 1);
    };
    const auto capped = ended({.iterations = 5, .absolute_tolerance = 1e-4, .relative_tolerance = 0});
    EXPECT_FALSE(capped.converged);
    EXPECT_EQ(capped.iterations, 5u);
    EXPECT_GT(capped.residual, 1e-4);
    const auto whole = ended({.iterations = 100000, .absolute_tolerance = 1e-4, .relative_tolerance = 0});
    EXPECT_TRUE(whole.converged);
    EXPECT_LE(whole.residual, 1e-4);
    // A limit of exactly the needed iterations does not stop the solver.
    EXPECT_TRUE(ended({.iterations = whole.iterations, .absolute_tolerance = 1e-4, .relative_tolerance = 0})
                    .converged);
    EXPECT_FALSE(
        ended({.iterations = whole.iterations - 1, .absolute_tolerance = 1e-4, .relative_tolerance = 0})
            .converged);
    EXPECT_TRUE(ended({.iterations = 5000, .absolute_tolerance = 0, .relative_tolerance = 0.1}).converged);
    contacts.clear();
    EXPECT_TRUE(ended({.iterations = 5}).converged);
}

INSTANTIATE_TEST_SUITE_P(Methods, SimulateSolver,
                         testing::Values(SolverSettings::Method::gauss_seidel,
                                         SolverSettings::Method::jacobi));

/// A body with four contacts falls on an immovable one; r-factors are too large by the factor `times`.
Problem four_legs(SolverSettings::Method method, double times) {
    Problem problem;
    problem.nodes.resize(2);
    problem.nodes[1] = {.velocity = {1, -2, 0.5},
                        .spin = {0.2, 0, -0.1},
                        .inverse_mass = 0.5,
                        .inverse_inertia = Eigen::Vector3d(1, 2, 3).asDiagonal()};
    for (const double x : {-0.5, 0.5})
        for (const double z : {-0.5, 0.5}) problem.rows.push_back(row_between({0, 0, 0}, {x, -0.5, z}, 0.2));
    set_factors(problem, method == SolverSettings::Method::jacobi);
    for (auto& row : problem.rows) {
        row.factor_normal *= times;
        row.factor_tangent *= times;
    }
    return problem;
}

void run(Problem& problem, const SolverSettings& settings) {
    if (settings.method == SolverSettings::Method::jacobi)
        jacobi(problem, settings, 1);
    else
        gauss_seidel(problem, settings);
}

TEST_P(SimulateSolver, RecoversFromFactorsThatAreTooLarge) {
    auto problem = four_legs(GetParam(), 5);
    const auto free = problem.nodes[1].velocity;
    run(problem, exact(GetParam()));
    Eigen::Vector3d pushed = Eigen::Vector3d::Zero();
    for (const auto& row : problem.rows) {
        pushed += simulate::world(row, row.impulse);
        EXPECT_NEAR(dot(row.normal, problem.velocity(row)), 0, 1e-6);
    }
    EXPECT_LT(length(free + 0.5 * pushed - problem.nodes[1].velocity), 1e-9);
}

TEST_P(SimulateSolver, ADivergingPassIsUndone) {
    auto start = four_legs(GetParam(), 12);
    auto solved = four_legs(GetParam(), 1);
    run(solved, exact(GetParam()));
    // Near the solution no impulse is clamped to zero, and the error grows from the first pass on.
    for (std::size_t i = 0; i < start.rows.size(); ++i)
        start.rows[i].impulse = 1.001 * solved.rows[i].impulse;
    int undone = 0;
    Problem last = start;
    for (std::size_t passes = 1; passes < 10; ++passes) {
        auto problem = start;
        auto settings = exact(GetParam());
        settings.iterations = passes;
        run(problem, settings);
        bool same = true;
        for (std::size_t i = 0; i < problem.rows.size(); ++i)
            same = same && problem.rows[i].impulse == last.rows[i].impulse;
        undone += same;
        if (same && passes > 1) {
            EXPECT_EQ(problem.nodes[1].velocity, last.nodes[1].velocity);
        }
        last = std::move(problem);
    }
    EXPECT_GT(undone, 2);
}

TEST(SimulateSolverConvergence, AfterDivergenceVelocitiesStillMatchImpulses) {
    auto world = stacks(1, 6);
    const Beginning start(world);
    const auto& [scene, model, motion, free, contacts] = start;
    for (std::size_t iterations = 1; iterations < 40; ++iterations) {
        auto problem = make_problem(model, motion, free, contacts);
        solve(problem, {.iterations = iterations, .absolute_tolerance = 0, .relative_tolerance = 0}, 1);
        auto end = free;
        add_impulses(model, problem, end);
        for (std::size_t i = 1; i < scene.bodies.size(); ++i)
            ASSERT_LT(length(end.rigid[i].velocity - problem.nodes[i].velocity), 1e-12) << iterations;
    }
}

TEST(SimulateSolverThreads, JacobiHasTheSameBitsOnAnyNumberOfThreads) {
    auto world = stacks(16, 5);
    const Beginning start(world);
    const auto& [scene, model, motion, free, contacts] = start;
    ASSERT_GT(contacts.size(), 5000u);
    std::vector<Problem> solved;
    for (const unsigned threads : {1u, 2u, 5u}) {
        solved.push_back(make_problem(model, motion, free, contacts));
        solve(solved.back(), {.method = SolverSettings::Method::jacobi, .iterations = 50}, threads);
    }
    for (std::size_t i = 0; i < solved[0].rows.size(); ++i) {
        ASSERT_EQ(solved[0].rows[i].impulse, solved[1].rows[i].impulse);
        ASSERT_EQ(solved[0].rows[i].impulse, solved[2].rows[i].impulse);
    }
    for (std::size_t i = 0; i < solved[0].nodes.size(); ++i)
        ASSERT_EQ(solved[0].nodes[i].spin, solved[2].nodes[i].spin);
}

} // namespace
} // namespace tandem::simulate
