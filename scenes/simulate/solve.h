// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/problem.h"

#include <limits>

namespace tandem::simulate {

/// The settings of a step of `time` s, with a tolerance in place of one of 0: 1e-5 of the impulse that holds
/// the scene's lightest body against gravity for the step, and without gravity of one that takes a hundredth
/// of the greatest speed at the start from it.
SolverSettings solver_of(const Model& model, double time);

/// How a solver ended.
struct SolveReport {
    std::size_t iterations = 0;
    double residual = 0;   ///< N s: largest change of an impulse in the last pass at full r-factors
    bool converged = true; ///< it ended by a tolerance, or there was nothing to solve
};

/// Solves for the rows' impulses from those they have, and brings nodes' velocities to match. The proximal
/// point method of Erleben, "Rigid body contact problems using proximal operators", SCA 2017: with
/// z = impulse - R w, the normal impulse becomes max(0, z_n) and the tangential one z_t projected onto the
/// disk of radius friction * normal impulse. Ends when the residual is below absolute_tolerance, when it
/// differs from the one before by less than relative_tolerance of it, or after `iterations`. A pass that
/// raises the residual is undone and the r-factors are reduced by 0.9. The result is the same for any number
/// of `threads`; Gauss-Seidel uses one.
SolveReport solve(Problem& problem, const SolverSettings& settings, unsigned threads);

/// The same for a step: where the impulses would give the bodies energy, which Newton's restitution and
/// friction at several contacts together can (Kane and Levinson, "Dynamics: theory and applications", 1985),
/// solves again without restitution; so that what is left to add energy is forces. Iterations are of both.
SolveReport solve_bounded(Problem& problem, const SolverSettings& settings, unsigned threads);

/// Proximal point of one row: its new impulse where `velocity` is that of b against a, at r-factors times
/// `scale`.
Eigen::Vector3d proximal(const ContactRow& row, const Eigen::Vector3d& velocity, double scale);

/// Says after every pass what to do next. A pass that changes impulses by more than the one before diverges:
/// r-factors are reduced, and grow back with every pass that does not (waiting longer was measured: stacks
/// converge slower). The residual is the change divided by the reduction, so that small steps are not taken
/// for convergence.
class Convergence {
public:
    enum class Verdict { go_on, converged, diverged };

    explicit Convergence(const SolverSettings& settings) : settings_(settings) {}
    /// `change`: the largest of an impulse in this pass.
    Verdict judge(double change);
    double scale() const { return scale_; } ///< of the r-factors in the next pass
    double residual() const { return residual_; }

private:
    const SolverSettings& settings_;
    double residual_ = std::numeric_limits<double>::max();
    double allowed_ = std::numeric_limits<double>::max();
    double scale_ = 1;
};

/// The two methods; `problem` has its r-factors.
SolveReport gauss_seidel(Problem& problem, const SolverSettings& settings);
SolveReport jacobi(Problem& problem, const SolverSettings& settings, unsigned threads);

} // namespace tandem::simulate
