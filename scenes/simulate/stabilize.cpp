// SPDX-License-Identifier: MIT
#include "scenes/simulate/stabilize.h"

#include "scenes/simulate/algebra.h"
#include "scenes/simulate/rotation.h"
#include "scenes/simulate/solve.h"

#include <algorithm>

namespace tandem::simulate {

namespace {

void move_by(const Model& model, const Problem& problem, double time, MotionState& motion) {
    auto vertex = model.bodies.size();
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        const auto& node = problem.nodes[i];
        for (auto& position : motion.soft[i].positions) position += time * problem.nodes[vertex++].velocity;
        if (model.bodies[i].kind != BodyKind::rigid) continue;
        motion.rigid[i].centre += time * node.velocity;
        motion.rigid[i].rotation = turned(motion.rigid[i].rotation, time * node.spin);
    }
}

/// Potential energy (J) added when bodies and vertices move at their nodes' velocities for `time` s.
double lifted(const Model& model, const Problem& problem, double time) {
    double sum = 0;
    for (const auto& node : problem.nodes)
        if (node.inverse_mass > 0)
            sum -= time * dot(model.dynamics->gravity, node.velocity) / node.inverse_mass;
    return sum;
}

/// An absolute_tolerance of 0 is replaced by a tenth of the tolerated penetration.
SolverSettings position_solver(const Model& model, double time) {
    auto settings = model.dynamics->solver;
    if (!(settings.absolute_tolerance > 0))
        settings.absolute_tolerance = 0.1 * tolerated_gap * model.smallest * model.lightest / time;
    return settings;
}

} // namespace

double pair_size(const Model& model, const Pair& pair) {
    const auto& a = model.bodies[pair.body_a];
    const auto& b = model.bodies[pair.body_b];
    if (a.kind == BodyKind::fixed) return b.size;
    if (b.kind == BodyKind::fixed) return a.size;
    return std::min(a.size, b.size);
}

double separation_bias(double depth, double size, double time) {
    if (!(depth < -tolerated_gap * size)) return 0;
    return -std::min(gap_reduction * -depth, greatest_correction * size) / time;
}

double layer_of(const Model& model, const Pair& pair, double time) {
    const double relative_layer = model.dynamics->stepping.contact_layer;
    if (!(relative_layer > 0)) return 0;
    // The solver shifts load between contacts by the difference of their velocities. It needs hundreds of
    // passes when this is less than a hundredth of what gravity adds in a step.
    constexpr double part_of_fall = 0.01;
    const double size = pair_size(model, pair);
    const double fall = length(model.dynamics->gravity) * time * time;
    return std::max(relative_layer * size, std::min(part_of_fall * fall, 0.5 * tolerated_gap * size));
}

double settling(double depth, double layer, double time) {
    // The speed is equal for all contacts: speeds from rounded depths would differ, which a flat face cannot
    // follow. Two steps at 0.6 pass the layer, so that no step ends at its limit, where rounding would
    // decide.
    constexpr double part = 0.6;
    return depth > -layer ? part * layer / time : 0;
}

double correct_positions(const Model& model, Problem problem, std::span<const ContactPoint> contacts,
                         double half, MotionState& motion) {
    for (std::size_t i = 0; i < problem.rows.size(); ++i) {
        auto& row = problem.rows[i];
        const auto& contact = contacts[problem.sources[i]];
        const double depth = contact.depth + half * dot(row.normal, problem.velocity(row));
        // Corrected vertices would strain their body, which then oscillates.
        const bool deformable = row.a.attached || row.b.attached;
        row.bias = deformable ? 0 : separation_bias(depth, pair_size(model, contact.pair), 2 * half);
        row.friction = 0;
        row.impulse.setZero();
    }
    for (auto& node : problem.nodes) node.velocity = node.spin = Eigen::Vector3d::Zero();
    solve(problem, position_solver(model, 2 * half), 1);
    move_by(model, problem, 2 * half, motion);
    return lifted(model, problem, 2 * half);
}

} // namespace tandem::simulate
