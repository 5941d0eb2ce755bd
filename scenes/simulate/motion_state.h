// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/simulate/model.h"

namespace tandem::simulate {

/// A rigid body in motion. Momentum, not spin, is the state: it is what free motion keeps, so the gyroscopic
/// term needs no force, and kinetic energy never exceeds |angular|^2 / (2 least moment of inertia).
struct RigidState {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< m, of mass
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero(); ///< m/s, of the centre
    Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< kg m^2/s, momentum about the centre
};

/// A deformable body in motion, by vertex.
struct SoftState {
    std::vector<Eigen::Vector3d> positions, velocities; ///< m, m/s
};

/// The impulse of a contact (N s, on body b), kept for the next step.
struct Impulse {
    Pair pair;
    std::uint32_t feature = 0;
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
};

/// Everything the next step depends on.
struct Motion {
    std::vector<RigidState> rigid; ///< one a body; only those of rigid bodies mean anything
    std::vector<SoftState> soft;   ///< one a body; empty unless deformable
    std::vector<Impulse> impulses; ///< in the order of reduce_contacts; empty unless warm_start
    double length = 0;             ///< s, of the step whose impulses these are
};

/// At frame 0 with the velocities of the dynamics; no impulses.
Motion starting_motion(const Model& model);

/// Positions after `time` (s) of free motion: velocities and momenta stay.
void drift(const Model& model, Motion& motion, double time);

/// Velocities after `time` (s) of gravity, damping and elastic forces at the present positions.
void kick(const Model& model, Motion& motion, double time);

/// Poses of rigid bodies about the mesh's own origin, vertices of deformable ones; fixed bodies as at the
/// start.
Frame frame_of(const Model& model, const Motion& motion);

/// R I^-1 R', 1 / (kg m^2).
Eigen::Matrix3d world_inverse_inertia(const BodyModel& body, const RigidState& state);
Eigen::Vector3d spin(const BodyModel& body, const RigidState& state); ///< rad/s

/// J; potential is zero at the origin's height.
struct Energies {
    double kinetic = 0, potential = 0, elastic = 0;
    std::size_t inverted = 0; ///< elements turned inside out

    double total() const { return kinetic + potential + elastic; }
};
/// Of one body; all zero for a fixed one.
Energies energies_of(const Model& model, const Motion& motion, std::size_t body);

/// J, the sum over all bodies.
double total_energy(const Model& model, const Motion& motion);

/// The same by kind. Throws InputError naming `step`, the body and its values when one of them is not
/// finite or their sum exceeds model.highest_energy.
Energies checked_energies(const Model& model, const Motion& motion, std::size_t step);

/// An energy that the motion cannot reach: ten times what it starts with in motion and strain, could gain by
/// falling through its own extent, and could be given by the corrections of penetration in one step, above
/// the total it starts with.
double highest_energy(const Model& model, const Motion& start);

} // namespace tandem::simulate
