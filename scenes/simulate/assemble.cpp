// SPDX-License-Identifier: MIT
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/problem.h"

#include <algorithm>
#include <cmath>

namespace tandem::simulate {

namespace {

/// First vertex node of each body. Nodes are one a body, then the vertices of deformable bodies in body
/// order.
std::vector<std::size_t> first_vertices(const Model& model) {
    std::vector<std::size_t> first;
    auto next = model.bodies.size();
    for (const auto& body : model.bodies) {
        first.push_back(next);
        next += body.elastic.masses.size();
    }
    return first;
}

/// A fixed or deformable body has a node that no impulse moves, so that body numbers are node numbers.
std::vector<MovedNode> make_nodes(const Model& model, const MotionState& motion) {
    std::vector<MovedNode> nodes(model.bodies.size());
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        const auto& body = model.bodies[i];
        const auto& soft = motion.soft[i];
        for (std::size_t v = 0; v < soft.velocities.size(); ++v)
            nodes.push_back({.velocity = soft.velocities[v], .inverse_mass = body.elastic.inverse_masses[v]});
        if (body.kind != BodyKind::rigid) continue;
        const auto& rigid = motion.rigid[i];
        nodes[i] = {rigid.velocity, spin(body, rigid), 1 / body.mass.mass,
                    world_inverse_inertia(body, rigid)};
    }
    return nodes;
}

/// Barycentric coordinates, clamped into the tetrahedron; those of the centre when the tetrahedron is flat.
std::array<double, 4> weights_of(const std::array<Eigen::Vector3d, 4>& corners,
                                 const Eigen::Vector3d& point) {
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = corners[static_cast<std::size_t>(i) + 1] - corners[0];
    // A flat tetrahedron gives infinities, which are handled below.
    const double det = determinant(edges);
    const Eigen::Vector3d local = apply(adjugate(edges), point - corners[0]) / det;
    std::array<double, 4> weights = {1 - ((local.x() + local.y()) + local.z()), local.x(), local.y(),
                                     local.z()};
    double sum = 0;
    for (auto& weight : weights) {
        weight = std::clamp(weight, 0.0, 1.0);
        sum += weight;
    }
    if (!std::isfinite(sum) || det == 0) return {0.25, 0.25, 0.25, 0.25};
    for (auto& weight : weights) weight /= sum;
    return weights;
}

class Assembler {
public:
    Assembler(const Model& model, const MotionState& before, const MotionState& free)
        : model_(model), before_(before), first_(first_vertices(model)) {
        problem_.nodes = make_nodes(model, before);
        free_ = make_nodes(model, free);
    }

    Problem run(std::span<const ContactPoint> contacts) {
        problem_.rows.reserve(contacts.size());
        for (std::size_t i = 0; i < contacts.size(); ++i)
            if (is_relevant(contacts[i].pair)) add(contacts[i], static_cast<std::uint32_t>(i));
        problem_.nodes = std::move(free_);
        return std::move(problem_);
    }

private:
    bool is_relevant(const Pair& pair) const {
        const auto a = model_.bodies[pair.body_a].kind, b = model_.bodies[pair.body_b].kind;
        if (!model_.dynamics->stepping.couple_contacts && (a == BodyKind::soft || b == BodyKind::soft))
            return false;
        // A rigid body cannot push itself.
        return (a != BodyKind::fixed || b != BodyKind::fixed)
               && (pair.body_a != pair.body_b || a == BodyKind::soft);
    }

    void add(const ContactPoint& contact, std::uint32_t source) {
        const Eigen::Vector3d point(contact.point[0], contact.point[1], contact.point[2]);
        ContactRow row;
        row.normal = {contact.normal[0], contact.normal[1], contact.normal[2]};
        const auto basis = tangents(row.normal);
        row.tangent = basis[0];
        row.binormal = basis[1];
        attach(contact.pair.body_a, contact.pair.tet_a, point, row.a, row.arm_a);
        attach(contact.pair.body_b, contact.pair.tet_b, point, row.b, row.arm_b);
        if (!movable(row.a) && !movable(row.b)) return;
        const auto& surface = model_.surface(contact.pair.body_a, contact.pair.body_b);
        row.friction = surface.friction;
        if (model_.dynamics->stepping.bounce)
            row.bias = row.bounce = surface.restitution * dot(row.normal, problem_.velocity(row));
        problem_.rows.push_back(row);
        problem_.sources.push_back(source);
    }

    void attach(std::uint32_t body, std::uint32_t tet, const Eigen::Vector3d& point, RowSide& side,
                Eigen::Vector3d& arm) {
        arm = Eigen::Vector3d::Zero();
        side = {body, false};
        if (model_.bodies[body].kind == BodyKind::rigid) arm = point - before_.rigid[body].centre;
        if (model_.bodies[body].kind != BodyKind::soft) return;
        const auto& tetrahedron = model_.scene->meshes[model_.scene->bodies[body].mesh].tetrahedra[tet];
        Attachment attachment;
        std::array<Eigen::Vector3d, 4> corners;
        for (std::size_t i = 0; i < 4; ++i) {
            attachment.nodes[i] = static_cast<std::uint32_t>(first_[body] + tetrahedron[i]);
            corners[i] = before_.soft[body].positions[tetrahedron[i]];
        }
        attachment.weights = weights_of(corners, point);
        side = {static_cast<std::uint32_t>(problem_.attachments.size()), true};
        problem_.attachments.push_back(attachment);
    }

    /// True when an impulse moves the side: not for fixed bodies, nor when all corners with weight are
    /// pinned.
    bool movable(const RowSide& side) const {
        bool result = false;
        for_each_node(problem_, side, Eigen::Vector3d::Zero(),
                      [&](std::uint32_t node, double weight, const Eigen::Vector3d&) {
                          result = result || weight * weight * problem_.nodes[node].inverse_mass > 0;
                      });
        return result;
    }

    const Model& model_;
    const MotionState& before_;
    std::vector<std::size_t> first_;
    Problem problem_;
    std::vector<MovedNode> free_;
};

} // namespace

Problem make_problem(const Model& model, const MotionState& before, const MotionState& free,
                     std::span<const ContactPoint> contacts) {
    return Assembler(model, before, free).run(contacts);
}

} // namespace tandem::simulate
