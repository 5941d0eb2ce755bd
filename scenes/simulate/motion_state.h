// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/simulate/model.h"

namespace tandem::simulate {

/// State of a rigid body. It has the angular momentum instead of the spin, since free motion conserves it.
/// Thus the gyroscopic term needs no force, and rotational energy is at most
/// |angular|^2 / (2 least moment of inertia).
struct RigidState {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< m, centre of mass
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero(); ///< m/s, velocity of the centre
    Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< kg m^2/s, momentum about the centre
};

/// State of a deformable body, by vertex.
struct SoftState {
    std::vector<Eigen::Vector3d> positions, velocities; ///< m, m/s
};

/// The impulse of a contact (N s, on body b), stored for the next step.
struct Impulse {
    Pair pair;
    std::uint32_t feature = 0;
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
};

/// The complete input of the next step.
struct MotionState {
    std::vector<RigidState> rigid; ///< one a body; undefined unless the body is rigid
    std::vector<SoftState> soft;   ///< one a body; empty unless deformable
    std::vector<Impulse> impulses; ///< in the order of reduce_contacts; empty unless warm_start
    double length = 0;             ///< s, length of the step that made the impulses
};

/// The motion at frame 0: velocities of the dynamics, no impulses.
MotionState starting_motion(const Model& model);

/// Advances positions by `time` (s) of free motion; velocities and momenta do not change.
void drift(const Model& model, MotionState& motion, double time);

/// Advances velocities by `time` (s) of gravity, damping and elastic forces at the present positions.
void kick(const Model& model, MotionState& motion, double time);

/// Poses of rigid bodies about the mesh's origin and vertices of deformable bodies. Fixed bodies have their
/// initial pose.
Frame frame_of(const Model& model, const MotionState& motion);

/// R I^-1 R', 1 / (kg m^2).
Eigen::Matrix3d world_inverse_inertia(const BodyModel& body, const RigidState& state);
Eigen::Vector3d spin(const BodyModel& body, const RigidState& state); ///< rad/s

/// Energies in J; the potential energy is zero at the origin's height.
struct Energies {
    double kinetic = 0, potential = 0, elastic = 0;
    std::size_t inverted = 0; ///< number of inverted elements

    double total() const { return kinetic + potential + elastic; }
};
/// Energies of one body; all zero for a fixed body.
Energies energies_of(const Model& model, const MotionState& motion, std::size_t body);

/// Sum of all energies of all bodies, J.
double total_energy(const Model& model, const MotionState& motion);

/// Energies of all bodies by kind. Throws InputError with `step`, the body and its values when one is not
/// finite or the sum exceeds model.highest_energy.
Energies checked_energies(const Model& model, const MotionState& motion, std::size_t step);

/// Upper limit of the total energy, J: the initial total plus ten times the sum of three terms. They are the
/// initial kinetic and elastic energy, a fall through the extent of all bodies, and the largest corrections
/// of penetration in one step.
double highest_energy(const Model& model, const MotionState& start);

} // namespace tandem::simulate
