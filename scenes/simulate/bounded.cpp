// SPDX-License-Identifier: MIT
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/solve.h"

#include <algorithm>
#include <cmath>

namespace tandem::simulate {

namespace {

/// Fraction of the work at the initial velocities; a smaller energy gain is within the solver's tolerance.
constexpr double negligible = 1e-3;

std::vector<Eigen::Vector3d> velocities(const Problem& problem) {
    std::vector<Eigen::Vector3d> result;
    result.reserve(problem.rows.size());
    for (const auto& row : problem.rows) result.push_back(problem.velocity(row));
    return result;
}

/// True when the impulses add energy. The work of an impulse is at the mean of velocities before and after
/// it.
bool adds_energy(const Problem& problem, std::span<const Eigen::Vector3d> before) {
    double gained = 0, moved = 0;
    for (std::size_t i = 0; i < problem.rows.size(); ++i) {
        const auto& row = problem.rows[i];
        const Eigen::Vector3d impulse = world(row, row.impulse);
        gained += 0.5 * dot(impulse, before[i] + problem.velocity(row));
        moved += std::fabs(dot(impulse, before[i]));
    }
    return gained > negligible * moved;
}

} // namespace

SolveReport solve_bounded(Problem& problem, const SolverSettings& settings, unsigned threads) {
    const bool bounces = std::any_of(problem.rows.begin(), problem.rows.end(),
                                     [](const ContactRow& row) { return row.bounce != 0; });
    if (!bounces) return solve(problem, settings, threads);
    const auto before = velocities(problem);
    auto without_bounce = problem;
    const auto first = solve(problem, settings, threads);
    if (!adds_energy(problem, before)) return first;
    for (auto& row : without_bounce.rows) row.bias -= row.bounce;
    problem = std::move(without_bounce);
    auto second = solve(problem, settings, threads);
    second.iterations += first.iterations;
    return second;
}

} // namespace tandem::simulate
