// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/problem.h"
#include "scenes/simulate/simulation.h"

namespace tandem::simulate {

/// Result of a step.
struct StepOutcome {
    MotionState end;
    Frame midway;
    StepReport report; ///< without step, time and energies
};

/// Runs one step of `length` s from `from` by Moreau's midpoint rule (Jean, "The non-smooth contact dynamics
/// method", Comput. Methods Appl. Mech. Eng. 177, 1999). It has half a step of motion, then forces and
/// contacts at midway, then half a step with the new velocities. Vertices of deformable bodies follow the
/// same rule, which is symplectic Euler from midway to midway. Throws InputError with `step` for contacts out
/// of order or impossible.
StepOutcome advance(const Model& model, const MotionState& from, double length, std::size_t step,
                    const Detect& detect);

/// Throws InputError unless contacts are in ascending order of (pair, feature), have existing bodies and
/// tetrahedra, finite numbers and normals of length 1.
void check_contacts(const Model& model, std::span<const ContactPoint> contacts, std::size_t step);

/// keep_impulses returns the impulses of `problem` for the next step. reuse_impulses writes them, times
/// `ratio`, to the rows of the next step's contacts.
std::vector<Impulse> keep_impulses(const Problem& problem, std::span<const ContactPoint> contacts);
void reuse_impulses(std::span<const Impulse> impulses, double ratio, std::span<const ContactPoint> contacts,
                    Problem& problem);

} // namespace tandem::simulate
