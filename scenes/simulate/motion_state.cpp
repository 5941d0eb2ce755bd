// SPDX-License-Identifier: MIT
#include "scenes/simulate/motion_state.h"

#include "scenes/simulate/rotation.h"

namespace tandem::simulate {

namespace {

/// Converts the spin w (rad/s, world axes) to the momentum R I R' w.
RigidState starting_rigid(const BodyModel& body, const BodyDynamics& dynamics, const Pose& pose) {
    RigidState state;
    state.rotation = unit(pose.rotation);
    state.centre = pose.translation + rotated(state.rotation, body.mass.centre);
    state.velocity = dynamics.velocity;
    const Eigen::Matrix3d r = rotation_matrix(state.rotation);
    state.angular = apply(r, apply(body.mass.inertia, apply(r.transpose(), dynamics.spin)));
    return state;
}

/// Applies velocity and spin about the centre of mass to all vertices except pinned vertices.
SoftState starting_soft(const ElasticMesh& mesh, const BodyDynamics& dynamics,
                        const std::vector<Eigen::Vector3d>& vertices) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double mass = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        centre += mesh.masses[i] * vertices[i];
        mass += mesh.masses[i];
    }
    centre /= mass;
    SoftState state{vertices, {}};
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Eigen::Vector3d velocity = dynamics.velocity + cross(dynamics.spin, vertices[i] - centre);
        state.velocities.push_back(mesh.inverse_masses[i] > 0 ? velocity : Eigen::Vector3d::Zero());
    }
    return state;
}

/// Free rotation by the midpoint rule. The spin of a constant momentum changes with the rotation; the spin at
/// the start of the step would add energy in every step.
void turn_on(const BodyModel& body, RigidState& state, double time) {
    const auto start = state.rotation;
    state.rotation = turned(start, time / 2 * spin(body, state));
    state.rotation = turned(start, time * spin(body, state));
}

/// Explicit integration with forces at the present positions. The stiffest element limits the step.
void kick_soft(const ElasticMesh& mesh, SoftState& state, const Eigen::Vector3d& gravity, double time) {
    std::vector<Eigen::Vector3d> forces(state.positions.size(), Eigen::Vector3d::Zero());
    add_elastic_forces(mesh, state.positions, forces);
    add_damping_forces(mesh, state.velocities, forces);
    for (std::size_t i = 0; i < forces.size(); ++i)
        if (mesh.inverse_masses[i] > 0)
            state.velocities[i] += time * (gravity + mesh.inverse_masses[i] * forces[i]);
}

} // namespace

MotionState starting_motion(const Model& model) {
    MotionState motion;
    motion.rigid.resize(model.bodies.size());
    motion.soft.resize(model.bodies.size());
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        const auto& body = model.bodies[i];
        const auto& dynamics = model.dynamics->bodies[i];
        if (body.kind == BodyKind::rigid)
            motion.rigid[i] = starting_rigid(body, dynamics, model.start.poses[i]);
        if (body.kind == BodyKind::soft)
            motion.soft[i] = starting_soft(body.elastic, dynamics, model.start.deformed[i]);
    }
    return motion;
}

void drift(const Model& model, MotionState& motion, double time) {
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        auto& soft = motion.soft[i];
        for (std::size_t v = 0; v < soft.positions.size(); ++v)
            soft.positions[v] += time * soft.velocities[v];
        if (model.bodies[i].kind != BodyKind::rigid) continue;
        auto& rigid = motion.rigid[i];
        rigid.centre += time * rigid.velocity;
        turn_on(model.bodies[i], rigid, time);
    }
}

void kick(const Model& model, MotionState& motion, double time) {
    const auto& dynamics = *model.dynamics;
    // Damping is implicit, so that no coefficient reverses a velocity.
    const double linear = 1 / (1 + time * dynamics.stepping.linear_damping);
    const double angular = 1 / (1 + time * dynamics.stepping.angular_damping);
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        if (model.bodies[i].kind == BodyKind::soft)
            kick_soft(model.bodies[i].elastic, motion.soft[i], dynamics.gravity, time);
        if (model.bodies[i].kind != BodyKind::rigid) continue;
        auto& rigid = motion.rigid[i];
        rigid.velocity = linear * (rigid.velocity + time * dynamics.gravity);
        rigid.angular *= angular;
    }
}

Frame frame_of(const Model& model, const MotionState& motion) {
    Frame frame = model.start;
    frame.deformed.resize(model.bodies.size());
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        const auto& body = model.bodies[i];
        if (body.kind == BodyKind::soft) frame.deformed[i] = motion.soft[i].positions;
        if (body.kind != BodyKind::rigid) continue;
        const auto& state = motion.rigid[i];
        frame.poses[i] = {state.rotation, state.centre - rotated(state.rotation, body.mass.centre)};
    }
    return frame;
}

Eigen::Matrix3d world_inverse_inertia(const BodyModel& body, const RigidState& state) {
    const Eigen::Matrix3d r = rotation_matrix(state.rotation);
    return multiply(multiply(r, body.inverse_inertia), r.transpose());
}

Eigen::Vector3d spin(const BodyModel& body, const RigidState& state) {
    const Eigen::Matrix3d r = rotation_matrix(state.rotation);
    return apply(r, apply(body.inverse_inertia, apply(r.transpose(), state.angular)));
}

} // namespace tandem::simulate
