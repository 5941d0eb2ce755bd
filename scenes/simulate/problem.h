// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/motion_state.h"

#include <array>
#include <span>

namespace tandem::simulate {

/// What impulses move: a rigid body, or a vertex of a deformable one (which has no inertia and no spin).
/// Bodies that do not move have inverse masses of 0.
struct Node {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero(); ///< m/s, with the impulses so far
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();     ///< rad/s
    double inverse_mass = 0;
    Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero(); ///< world axes
};

/// A point held by the four corners of its tetrahedron; weights are at least 0 and add up to 1.
struct Attachment {
    std::array<std::uint32_t, 4> nodes{};
    std::array<double, 4> weights{};
};

/// One side of a contact: a node, or an attachment when `attached`.
struct Side {
    std::uint32_t index = 0;
    bool attached = false;
};

/// A contact with friction: the velocity of b against a along normal, tangents (orthonormal) is made to obey
/// 0 <= velocity + bias, impulse >= 0, their product 0 in the normal and Coulomb's law in the tangents.
struct ContactRow {
    Eigen::Vector3d normal, tangent, binormal;
    Eigen::Vector3d arm_a, arm_b;                       ///< m, from the node to the point
    Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  ///< N s on b: normal, tangent, binormal
    Eigen::Vector3d previous = Eigen::Vector3d::Zero(); ///< of the last accepted pass
    double bias = 0;                                    ///< m/s
    double bounce = 0;                                  ///< m/s, what restitution adds to it
    double friction = 0;
    double factor_normal = 0, factor_tangent = 0; ///< r-factors, kg
    double mixed_tangent = 0, mixed_binormal = 0; ///< 1/kg: what a normal impulse does along the tangents
    Side a, b;
};

/// All contacts of a step as the solvers take them.
struct Problem {
    std::vector<Node> nodes;
    std::vector<Attachment> attachments;
    std::vector<ContactRow> rows;
    std::vector<std::uint32_t> sources; ///< per row the index of its contact

    /// Velocity of the point of a side.
    Eigen::Vector3d velocity(const Side& side, const Eigen::Vector3d& arm) const {
        if (side.attached) return attached_velocity(attachments[side.index]);
        const auto& node = nodes[side.index];
        return {node.velocity.x() + (node.spin.y() * arm.z() - node.spin.z() * arm.y()),
                node.velocity.y() + (node.spin.z() * arm.x() - node.spin.x() * arm.z()),
                node.velocity.z() + (node.spin.x() * arm.y() - node.spin.y() * arm.x())};
    }
    /// Of b against a.
    Eigen::Vector3d velocity(const ContactRow& row) const {
        return velocity(row.b, row.arm_b) - velocity(row.a, row.arm_a);
    }
    /// Pushes one side of a contact.
    void push(const Side& side, const Eigen::Vector3d& arm, const Eigen::Vector3d& impulse);
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
void for_each_node(const Problem& problem, const Side& side, const Eigen::Vector3d& arm, Visit visit) {
    if (!side.attached) return visit(side.index, 1.0, arm);
    const auto& attachment = problem.attachments[side.index];
    for (std::size_t i = 0; i < 4; ++i)
        visit(attachment.nodes[i], attachment.weights[i], Eigen::Vector3d(Eigen::Vector3d::Zero()));
}

/// Contacts of `contacts` at the positions of `before`, whose velocities give the bounce; nodes get the
/// velocities of `free`. Contacts that no impulse can change are left out, and so are those of deformable
/// bodies unless couple_contacts.
Problem make_problem(const Model& model, const Motion& before, const Motion& free,
                     std::span<const ContactPoint> contacts);

/// Sets the r-factors, 1 / A_ii (Erleben 2017, local strategy). With `split` each node's mass is divided
/// among its contacts (Tonge, Benevolenski and Voroshilov, "Mass splitting for jitter-free parallel rigid
/// body simulation", ACM Trans. Graph. 31(4), 2012), so that simultaneous updates converge.
void set_factors(Problem& problem, bool split);

/// Adds the rows' impulses to the motion's momenta.
void add_impulses(const Model& model, const Problem& problem, Motion& motion);

/// Two tangents that complete `normal` to a right-handed orthonormal basis (Duff et al., "Building an
/// orthonormal basis, revisited", J. Comput. Graph. Tech. 6(1), 2017).
std::array<Eigen::Vector3d, 2> tangents(const Eigen::Vector3d& normal);

} // namespace tandem::simulate
