// SPDX-License-Identifier: MIT
#include "scenes/simulate/problem.h"

#include "scenes/simulate/algebra.h"

#include <cmath>

namespace tandem::simulate {

Eigen::Vector3d Problem::attached_velocity(const Attachment& attachment) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 4; ++i) sum += attachment.weights[i] * nodes[attachment.nodes[i]].velocity;
    return sum;
}

void Problem::push(const RowSide& side, const Eigen::Vector3d& arm, const Eigen::Vector3d& impulse) {
    if (side.attached) {
        const auto& attachment = attachments[side.index];
        for (std::size_t i = 0; i < 4; ++i) {
            auto& node = nodes[attachment.nodes[i]];
            node.velocity += (attachment.weights[i] * node.inverse_mass) * impulse;
        }
        return;
    }
    auto& node = nodes[side.index];
    node.velocity += node.inverse_mass * impulse;
    node.spin += apply(node.inverse_inertia, cross(arm, impulse));
}

std::array<Eigen::Vector3d, 2> tangents(const Eigen::Vector3d& normal) {
    const double sign = std::copysign(1.0, normal.z());
    const double a = -1 / (sign + normal.z());
    const double b = normal.x() * normal.y() * a;
    return {Eigen::Vector3d(1 + sign * normal.x() * normal.x() * a, sign * b, -sign * normal.x()),
            Eigen::Vector3d(b, sign + normal.y() * normal.y() * a, -normal.y())};
}

namespace {

/// Change of a point's velocity by unit impulses at one side: the 3x3 block of Delassus' operator. `counts`,
/// when not empty, divides each node's mass.
Eigen::Matrix3d mobility(const Problem& problem, const RowSide& side, const Eigen::Vector3d& arm,
                         std::span<const double> counts) {
    Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
    for_each_node(problem, side, arm, [&](std::uint32_t index, double weight, const Eigen::Vector3d& lever) {
        const auto& node = problem.nodes[index];
        const double count = counts.empty() ? 1 : counts[index];
        const double linear = weight * weight * node.inverse_mass;
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
            const Eigen::Vector3d spin = apply(node.inverse_inertia, cross(lever, unit));
            result.col(axis) += count * (linear * unit + cross(spin, lever));
        }
    });
    return result;
}

/// Sets the r-factors of a row from its 3x3 block `k`: 1 / A_nn for the normal, one factor for both tangents.
void set_row_factors(ContactRow& row, const Eigen::Matrix3d& k) {
    const Eigen::Vector3d along = apply(k, row.normal);
    const Eigen::Vector3d across = apply(k, row.tangent);
    const double tt = dot(row.tangent, across);
    const double bb = dot(row.binormal, apply(k, row.binormal));
    // The friction disk needs one factor for both tangents. The sum of magnitudes in a row bounds the largest
    // eigenvalue of the block.
    const double greatest = std::max(tt, bb) + std::fabs(dot(row.binormal, across));
    row.factor_normal = 1 / dot(row.normal, along);
    row.factor_tangent = 1 / greatest;
    row.mixed_tangent = dot(row.tangent, along);
    row.mixed_binormal = dot(row.binormal, along);
}

/// Number of contact sides at each node, which is the number of parts of its mass.
std::vector<double> contacts_per_node(const Problem& problem) {
    std::vector<double> counts(problem.nodes.size(), 0);
    const auto count = [&](std::uint32_t node, double, const Eigen::Vector3d&) { counts[node] += 1; };
    for (const auto& row : problem.rows) {
        for_each_node(problem, row.a, row.arm_a, count);
        for_each_node(problem, row.b, row.arm_b, count);
    }
    return counts;
}

} // namespace

void set_factors(Problem& problem, bool split) {
    const auto counts = split ? contacts_per_node(problem) : std::vector<double>{};
    for (auto& row : problem.rows)
        set_row_factors(row, mobility(problem, row.a, row.arm_a, counts)
                                 + mobility(problem, row.b, row.arm_b, counts));
}

void add_impulses(const Model& model, const Problem& problem, MotionState& motion) {
    std::vector<Eigen::Vector3d> linear(problem.nodes.size(), Eigen::Vector3d::Zero());
    std::vector<Eigen::Vector3d> angular = linear;
    for (const auto& row : problem.rows) {
        const Eigen::Vector3d impulse = world(row, row.impulse);
        for (const double sign : {-1.0, 1.0})
            for_each_node(problem, sign < 0 ? row.a : row.b, sign < 0 ? row.arm_a : row.arm_b,
                          [&](std::uint32_t node, double weight, const Eigen::Vector3d& arm) {
                              linear[node] += (sign * weight) * impulse;
                              angular[node] += sign * cross(arm, impulse);
                          });
    }
    auto vertex = model.bodies.size();
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        if (model.bodies[i].kind == BodyKind::rigid) {
            motion.rigid[i].velocity += linear[i] / model.bodies[i].mass.mass;
            motion.rigid[i].angular += angular[i];
        }
        for (auto& velocity : motion.soft[i].velocities) {
            velocity += problem.nodes[vertex].inverse_mass * linear[vertex];
            ++vertex;
        }
    }
}

} // namespace tandem::simulate
