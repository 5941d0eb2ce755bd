// SPDX-License-Identifier: MIT
#include "tests/support/test.h"
#include "tests/unit/simulate/rows.h"
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/solve.h"
#include "tests/unit/simulate/support.h"

namespace tandem::simulate {
namespace {

using namespace unit_test;

TEST(SimulateRows, FactorsAreResponsesToUnitImpulses) {
    Problem problem;
    problem.nodes.resize(2);
    for (auto& node : problem.nodes) {
        node.inverse_mass = 0.5;
        node.inverse_inertia = Eigen::Vector3d(1, 2, 3).asDiagonal();
    }
    problem.rows = {row_between({0.3, -0.5, 0.2}, {-0.1, 0.4, 0.7}, 0.5)};
    set_factors(problem, false);
    const auto row = problem.rows[0];
    problem.push(row, row.normal);
    EXPECT_NEAR(dot(row.normal, problem.velocity(row)), 1 / row.factor_normal, 1e-14);
    EXPECT_NEAR(dot(row.tangent, problem.velocity(row)), row.mixed_tangent, 1e-14);
    EXPECT_NEAR(dot(row.binormal, problem.velocity(row)), row.mixed_binormal, 1e-14);
    EXPECT_GT(std::fabs(row.mixed_tangent), 0.01);
    EXPECT_GT(std::fabs(row.mixed_binormal), 0.01);
}

TEST(SimulateRows, AttachmentsInterpolateThePointOfContact) {
    World world;
    world.add(box({1, 1, 1}), at(0, 0, 0));
    Elastic elastic;
    elastic.young = 1000;
    auto mesh = beam({1, 1, 1}, {1, 1, 1});
    for (auto& v : mesh.vertices) v += Eigen::Vector3d(0.2, 0.49, 0.1);
    world.add_soft(std::move(mesh), elastic);
    const Beginning start(world);
    const auto& [scene, model, motion, free, contacts] = start;
    const auto problem = make_problem(model, motion, motion, contacts);
    ASSERT_GT(problem.rows.size(), 3u);
    for (std::size_t i = 0; i < problem.rows.size(); ++i) {
        const auto& attachment = problem.attachments[problem.rows[i].b.index];
        Eigen::Vector3d interpolated = Eigen::Vector3d::Zero();
        for (std::size_t corner = 0; corner < 4; ++corner)
            interpolated +=
                attachment.weights[corner] * motion.soft[1].positions[attachment.nodes[corner] - 2];
        const auto& point = contacts[problem.sources[i]].point;
        EXPECT_LT(length(interpolated - Eigen::Vector3d(point[0], point[1], point[2])), 1e-9);
    }
}

TEST(SimulateConvergence, UndoesAndReducesOnGrowthAndRecovers) {
    const SolverSettings settings{.absolute_tolerance = 0.001, .relative_tolerance = 0};
    Convergence convergence(settings);
    using enum Convergence::Verdict;
    EXPECT_EQ(convergence.judge(1), go_on);
    EXPECT_EQ(convergence.judge(2), diverged);
    EXPECT_DOUBLE_EQ(convergence.scale(), 0.9);
    EXPECT_DOUBLE_EQ(convergence.residual(), 1); // of the pass that was kept
    EXPECT_EQ(convergence.judge(0.9), go_on);
    EXPECT_DOUBLE_EQ(convergence.residual(), 1); // at full r-factors
    EXPECT_DOUBLE_EQ(convergence.scale(), 1);
    EXPECT_EQ(convergence.judge(0.001), converged);
}

TEST(SimulateConvergence, RelativeToleranceStopsAtStagnation) {
    const SolverSettings settings{.absolute_tolerance = 0, .relative_tolerance = 0.01};
    Convergence convergence(settings);
    EXPECT_EQ(convergence.judge(1), Convergence::Verdict::go_on);
    EXPECT_EQ(convergence.judge(0.95), Convergence::Verdict::go_on);
    EXPECT_EQ(convergence.judge(0.945), Convergence::Verdict::converged);
}

} // namespace
} // namespace tandem::simulate
