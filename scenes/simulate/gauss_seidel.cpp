// SPDX-License-Identifier: MIT
#include "scenes/simulate/solve.h"

namespace tandem::simulate {

namespace {

/// Updates all rows in order. Returns the largest change of an impulse, N s.
double sweep(Problem& problem, double scale) {
    double most = 0;
    for (auto& row : problem.rows) {
        row.previous = row.impulse;
        row.impulse = proximal(row, problem.velocity(row), scale);
        const Eigen::Vector3d change = row.impulse - row.previous;
        if (change == Eigen::Vector3d::Zero()) continue;
        problem.push(row, world(row, change));
        most = std::max(most, change.cwiseAbs().maxCoeff());
    }
    return most;
}

void undo(Problem& problem, std::vector<MovedNode>& accepted) {
    problem.nodes = accepted;
    for (auto& row : problem.rows) row.impulse = row.previous;
}

} // namespace

SolveReport gauss_seidel(Problem& problem, const SolverSettings& settings) {
    for (const auto& row : problem.rows)
        if (row.impulse != Eigen::Vector3d::Zero()) problem.push(row, world(row, row.impulse));
    Convergence convergence(settings);
    SolveReport report{.converged = false};
    auto accepted = problem.nodes;
    while (report.iterations < settings.iterations) {
        const auto verdict = convergence.judge(sweep(problem, convergence.scale()));
        ++report.iterations;
        report.converged = verdict == Convergence::Verdict::converged;
        if (report.converged) break;
        if (verdict == Convergence::Verdict::diverged)
            undo(problem, accepted);
        else
            accepted = problem.nodes;
    }
    report.residual = convergence.residual();
    return report;
}

} // namespace tandem::simulate
