// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/problem.h"

#include <limits>

namespace tandem::simulate {

/// Solver settings of a step of `time` s. An absolute_tolerance of 0 is replaced by 1e-5 of the lightest
/// body's weight times `time`. Without gravity it is 1e-5 of its mass times a hundredth of the greatest
/// initial speed.
SolverSettings solver_of(const Model& model, double time);

/// Result of a solver.
struct SolveReport {
    std::size_t iterations = 0;
    double residual = 0;   ///< N s: largest change of an impulse in the last pass at full r-factors
    bool converged = true; ///< stopped by a tolerance, or there was nothing to solve
};

/// Solves for the rows' impulses, starting from their values, and updates the nodes' velocities. Proximal
/// point method of Erleben, "Rigid body contact problems using proximal operators", SCA 2017. Let
/// z = impulse - R w. The normal impulse becomes max(0, z_n); the tangential impulse becomes z_t projected
/// onto the disk of radius friction * normal impulse. Stops when the residual is at most absolute_tolerance,
/// changes by less than relative_tolerance of the previous residual, or after `iterations`. A pass that
/// raises the residual is undone and multiplies the r-factors by 0.9. The result does not depend on
/// `threads`; Gauss-Seidel uses one.
SolveReport solve(Problem& problem, const SolverSettings& settings, unsigned threads);

/// As solve(), but solves again without restitution when the impulses add energy; then only forces can add
/// energy. Newton's restitution with friction at several contacts can add energy (Kane and Levinson,
/// "Dynamics: theory and applications", 1985). `iterations` in the report counts both solves.
SolveReport solve_bounded(Problem& problem, const SolverSettings& settings, unsigned threads);

/// New impulse of one row. `velocity` is that of b relative to a; r-factors are multiplied by `scale`.
Eigen::Vector3d proximal(const ContactRow& row, const Eigen::Vector3d& velocity, double scale);

/// Stopping criterion and scale of the r-factors. A pass diverges when it changes impulses by more than the
/// previous pass, which reduces the r-factors. Every other pass raises them again, since a longer wait makes
/// stacks converge slower. The residual is the change divided by the scale, so that short steps do not look
/// like convergence.
class Convergence {
public:
    enum class Verdict { go_on, converged, diverged };

    explicit Convergence(const SolverSettings& settings) : settings_(settings) {}
    /// Decides how to continue. `change` is the largest change of an impulse in this pass, N s.
    Verdict judge(double change);
    double scale() const { return scale_; } ///< scale of the r-factors in the next pass
    double residual() const { return residual_; }

private:
    const SolverSettings& settings_;
    double residual_ = std::numeric_limits<double>::max();
    double allowed_ = std::numeric_limits<double>::max();
    double scale_ = 1;
};

/// The two methods. The r-factors of `problem` must be set.
SolveReport gauss_seidel(Problem& problem, const SolverSettings& settings);
SolveReport jacobi(Problem& problem, const SolverSettings& settings, unsigned threads);

} // namespace tandem::simulate
