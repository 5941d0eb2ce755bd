// SPDX-License-Identifier: MIT
#include "scenes/simulate/stabilize.h"

#include "scenes/simulate/algebra.h"
#include "scenes/simulate/rotation.h"
#include "scenes/simulate/solve.h"

#include <algorithm>

namespace tandem::simulate {

namespace {

void move_by(const Model& model, const Problem& problem, double time, Motion& motion) {
    auto vertex = model.bodies.size();
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        const auto& node = problem.nodes[i];
        for (auto& position : motion.soft[i].positions) position += time * problem.nodes[vertex++].velocity;
        if (model.bodies[i].kind != Kind::rigid) continue;
        motion.rigid[i].centre += time * node.velocity;
        motion.rigid[i].rotation = turned(motion.rigid[i].rotation, time * node.spin);
    }
}

/// J, of bodies and vertices moved by their nodes' velocities for `time`.
double lifted(const Model& model, const Problem& problem, double time) {
    double sum = 0;
    for (const auto& node : problem.nodes)
        if (node.inverse_mass > 0)
            sum -= time * dot(model.dynamics->gravity, node.velocity) / node.inverse_mass;
    return sum;
}

/// A tolerance that is left to the scene is a tenth of the penetration that stays anyway.
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
    if (a.kind == Kind::fixed) return b.size;
    if (b.kind == Kind::fixed) return a.size;
    return std::min(a.size, b.size);
}

double separation_bias(double depth, double size, double time) {
    if (!(depth < -tolerated_gap * size)) return 0;
    return -std::min(gap_reduction * -depth, greatest_correction * size) / time;
}

double layer_of(const Model& model, const Pair& pair, double time) {
    const double share = model.dynamics->stepping.contact_layer;
    if (!(share > 0)) return 0;
    // A solver moves a load from one contact to another by what their velocities differ: where that is less
    // than a hundredth of what weight gives in a step, it takes hundreds of passes.
    constexpr double part_of_fall = 0.01;
    const double size = pair_size(model, pair);
    const double fall = length(model.dynamics->gravity) * time * time;
    return std::max(share * size, std::min(part_of_fall * fall, 0.5 * tolerated_gap * size));
}

double settling(double depth, double layer, double time) {
    // The same for all contacts: speeds that differ by what their depths are rounded by ask a flat face for
    // what it cannot do. Two steps from a touch, and beyond: no whole number of them ends where rounding
    // decides.
    constexpr double part = 0.6;
    return depth > -layer ? part * layer / time : 0;
}

double correct_positions(const Model& model, Problem problem, std::span<const ContactPoint> contacts,
                         double half, Motion& motion) {
    for (std::size_t i = 0; i < problem.rows.size(); ++i) {
        auto& row = problem.rows[i];
        const auto& contact = contacts[problem.sources[i]];
        const double depth = contact.depth + half * dot(row.normal, problem.velocity(row));
        // Vertices that are put elsewhere strain their body, which then shakes.
        const bool strains = row.a.attached || row.b.attached;
        row.bias = strains ? 0 : separation_bias(depth, pair_size(model, contact.pair), 2 * half);
        row.friction = 0;
        row.impulse.setZero();
    }
    for (auto& node : problem.nodes) node.velocity = node.spin = Eigen::Vector3d::Zero();
    solve(problem, position_solver(model, 2 * half), 1);
    move_by(model, problem, 2 * half, motion);
    return lifted(model, problem, 2 * half);
}

} // namespace tandem::simulate
