// SPDX-License-Identifier: MIT
#include "scenes/simulate/solve.h"

namespace tandem::simulate {

namespace {

/// One pass over all rows in order; the largest change of an impulse.
double sweep(Problem& problem, double scale) {
    double residual = 0;
    for (auto& row : problem.rows) {
        row.previous = row.impulse;
        row.impulse = proximal(row, problem.velocity(row), scale);
        const Eigen::Vector3d change = row.impulse - row.previous;
        if (change == Eigen::Vector3d::Zero()) continue;
        problem.push(row, world(row, change));
        residual = std::max(residual, change.cwiseAbs().maxCoeff());
    }
    return residual;
}

void undo(Problem& problem, std::vector<Node>& accepted) {
    problem.nodes = accepted;
    for (auto& row : problem.rows) row.impulse = row.previous;
}

} // namespace

SolveReport gauss_seidel(Problem& problem, const SolverSettings& settings) {
    for (const auto& row : problem.rows)
        if (row.impulse != Eigen::Vector3d::Zero()) problem.push(row, world(row, row.impulse));
    Convergence convergence(settings);
    SolveReport report;
    auto accepted = problem.nodes;
    for (; report.iterations < settings.iterations; ++report.iterations) {
        report.residual = sweep(problem, convergence.scale());
        const auto verdict = convergence.judge(report.residual);
        if (verdict == Convergence::Verdict::diverged) {
            undo(problem, accepted);
            continue;
        }
        if (verdict == Convergence::Verdict::converged) return {report.iterations + 1, report.residual};
        accepted = problem.nodes;
    }
    return report;
}

} // namespace tandem::simulate
