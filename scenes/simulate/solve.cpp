// SPDX-License-Identifier: MIT
#include "scenes/simulate/solve.h"

#include "scenes/simulate/algebra.h"

namespace tandem::simulate {

namespace {

constexpr double reduction = 0.9; ///< factor for the r-factors when a pass diverges
constexpr double part_of_weight = 1e-5;

} // namespace

SolverSettings solver_of(const Model& model, double time) {
    auto settings = model.dynamics->solver;
    if (settings.absolute_tolerance > 0) return settings;
    double speed = length(model.dynamics->gravity) * time;
    if (!(speed > 0)) speed = 0.01 * model.fastest;
    // Without gravity and initial motion, the smallest size sets the scale of speeds.
    if (!(speed > 0)) speed = 0.01 * model.smallest;
    settings.absolute_tolerance = part_of_weight * model.lightest * speed;
    return settings;
}

Eigen::Vector3d proximal(const ContactRow& row, const Eigen::Vector3d& velocity, double scale) {
    Eigen::Vector3d result;
    const double normal_velocity = dot(row.normal, velocity) + row.bias;
    result.x() = std::max(0.0, row.impulse.x() - scale * row.factor_normal * normal_velocity);
    // Rows are solved as blocks, normal first: the tangential velocities include the new normal impulse.
    const double change = result.x() - row.impulse.x();
    const double slide = dot(row.tangent, velocity) + row.mixed_tangent * change;
    const double slip = dot(row.binormal, velocity) + row.mixed_binormal * change;
    result.y() = row.impulse.y() - scale * row.factor_tangent * slide;
    result.z() = row.impulse.z() - scale * row.factor_tangent * slip;
    const double radius = row.friction * result.x();
    const double squared = result.y() * result.y() + result.z() * result.z();
    if (squared > radius * radius) {
        const double shrink = radius / std::sqrt(squared);
        result.y() *= shrink;
        result.z() *= shrink;
    }
    return result;
}

Convergence::Verdict Convergence::judge(double change) {
    // The change is divided by the scale to compare passes at full r-factors.
    const double before = residual_;
    residual_ = change / scale_;
    if (residual_ <= settings_.absolute_tolerance
        || std::fabs(residual_ - before) < settings_.relative_tolerance * before)
        return Verdict::converged;
    // The caller undoes the pass, so that the previous residual remains valid.
    if (change > allowed_) {
        scale_ *= reduction;
        residual_ = before;
        return Verdict::diverged;
    }
    const double grown = std::min(1.0, scale_ / reduction);
    allowed_ = change * (grown / scale_);
    scale_ = grown;
    return Verdict::go_on;
}

SolveReport solve(Problem& problem, const SolverSettings& settings, unsigned threads) {
    const bool parallel = settings.method == SolverSettings::Method::jacobi;
    set_factors(problem, parallel);
    if (problem.rows.empty()) return {};
    return parallel ? jacobi(problem, settings, threads) : gauss_seidel(problem, settings);
}

} // namespace tandem::simulate
