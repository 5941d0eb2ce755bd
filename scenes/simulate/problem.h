// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/motion_state.h"

#include <array>
#include <span>

namespace tandem::simulate {

/// An object that impulses move: a rigid body, or a vertex of a deformable body, which has no inertia and no
/// spin. Objects that do not move have an inverse mass of 0.
struct MovedNode {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero(); ///< m/s, including the present impulses
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();     ///< rad/s
    double inverse_mass = 0;
    Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero(); ///< world axes
};

/// A point of a tetrahedron by its barycentric weights, which are >= 0 and have the sum 1.
struct Attachment {
    std::array<std::uint32_t, 4> nodes{};
    std::array<double, 4> weights{};
};

/// One side of a contact: a node, or an attachment when `attached`.
struct RowSide {
    std::uint32_t index = 0;
    bool attached = false;
};

/// A contact with friction in an orthonormal basis. With the velocity of b relative to a, the normal
/// component satisfies velocity + bias >= 0, impulse >= 0 and product 0. The tangents satisfy Coulomb's law.
struct ContactRow {
    Eigen::Vector3d normal, tangent, binormal;
    Eigen::Vector3d arm_a, arm_b;                       ///< m, from the node to the point
    Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  ///< N s on b: normal, tangent, binormal
    Eigen::Vector3d previous = Eigen::Vector3d::Zero(); ///< impulse of the last accepted pass
    double bias = 0;                                    ///< m/s
    double bounce = 0;                                  ///< m/s, part of the bias from restitution
    double friction = 0;
    double factor_normal = 0, factor_tangent = 0; ///< r-factors, kg
    double mixed_tangent = 0, mixed_binormal = 0; ///< 1/kg, effect of a normal impulse along the tangents
    RowSide a, b;
};

/// All contacts of a step in the form that the solvers use.
struct Problem {
    std::vector<MovedNode> nodes;
    std::vector<Attachment> attachments;
    std::vector<ContactRow> rows;
    std::vector<std::uint32_t> sources; ///< one a row: the index of its contact

    /// Velocity of the point of a side.
    Eigen::Vector3d velocity(const RowSide& side, const Eigen::Vector3d& arm) const {
        if (side.attached) return attached_velocity(attachments[side.index]);
        const auto& node = nodes[side.index];
        return {node.velocity.x() + (node.spin.y() * arm.z() - node.spin.z() * arm.y()),
                node.velocity.y() + (node.spin.z() * arm.x() - node.spin.x() * arm.z()),
                node.velocity.z() + (node.spin.x() * arm.y() - node.spin.y() * arm.x())};
    }
    /// Velocity of b relative to a.
    Eigen::Vector3d velocity(const ContactRow& row) const {
        return velocity(row.b, row.arm_b) - velocity(row.a, row.arm_a);
    }
    /// Applies an impulse (N s) to one side of a contact.
    void push(const RowSide& side, const Eigen::Vector3d& arm, const Eigen::Vector3d& impulse);
    void push(const ContactRow& row, const Eigen::Vector3d& impulse) {
        push(row.a, row.arm_a, -impulse);
        push(row.b, row.arm_b, impulse);
    }

private:
    Eigen::Vector3d attached_velocity(const Attachment& attachment) const;
};

/// Impulse of a row in world axes.
inline Eigen::Vector3d world(const ContactRow& row, const Eigen::Vector3d& impulse) {
    return (impulse.x() * row.normal + impulse.y() * row.tangent) + impulse.z() * row.binormal;
}

/// Calls visit(node, weight, arm) for the one or four nodes of a side.
template<class Visit>
void for_each_node(const Problem& problem, const RowSide& side, const Eigen::Vector3d& arm, Visit visit) {
    if (!side.attached) return visit(side.index, 1.0, arm);
    const auto& attachment = problem.attachments[side.index];
    for (std::size_t i = 0; i < 4; ++i)
        visit(attachment.nodes[i], attachment.weights[i], Eigen::Vector3d(Eigen::Vector3d::Zero()));
}

/// Rows of `contacts` at the positions of `before`. The velocities of `before` define the bounce; nodes get
/// the velocities of `free`. Leaves out contacts that no impulse can change, and those of deformable bodies
/// unless couple_contacts is set.
Problem make_problem(const Model& model, const MotionState& before, const MotionState& free,
                     std::span<const ContactPoint> contacts);

/// Sets the r-factors, 1 / A_ii (Erleben 2017, local strategy). `split` divides each node's mass among its
/// contacts (Tonge, Benevolenski and Voroshilov, "Mass splitting for jitter-free parallel rigid
/// body simulation", ACM Trans. Graph. 31(4), 2012), so that simultaneous updates converge.
void set_factors(Problem& problem, bool split);

/// Adds the rows' impulses to the motion's momenta.
void add_impulses(const Model& model, const Problem& problem, MotionState& motion);

/// Two tangents that complete `normal` to a right-handed orthonormal basis (Duff et al., "Building an
/// orthonormal basis, revisited", J. Comput. Graph. Tech. 6(1), 2017).
std::array<Eigen::Vector3d, 2> tangents(const Eigen::Vector3d& normal);

} // namespace tandem::simulate
