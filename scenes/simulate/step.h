// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/problem.h"
#include "scenes/simulate/simulation.h"

namespace tandem::simulate {

/// What a step made.
struct Outcome {
    Motion end;
    Frame midway;
    StepReport report; ///< but for step, time and energies
};

/// One step of `length` s from `from`, by Moreau's midpoint rule (Jean, "The non-smooth contact dynamics
/// method", Comput. Methods Appl. Mech. Eng. 177, 1999): half a step of motion, forces and contacts there,
/// half a step with the new velocities. Vertices of deformable bodies move by the same rule, so that from
/// midway to midway they take symplectic Euler steps. Throws InputError, naming `step`, when contacts are out
/// of order or impossible.
Outcome advance(const Model& model, const Motion& from, double length, std::size_t step,
                const Detect& detect);

/// Throws InputError unless contacts are in ascending order of (pair, feature), between bodies and tetrahedra
/// that exist, with finite numbers and normals of length 1.
void check_contacts(const Model& model, std::span<const ContactPoint> contacts, std::size_t step);

/// Impulses of `problem` for the next step, and back into the rows of the next step's contacts, times
/// `ratio`.
std::vector<Impulse> keep_impulses(const Problem& problem, std::span<const ContactPoint> contacts);
void reuse_impulses(std::span<const Impulse> impulses, double ratio, std::span<const ContactPoint> contacts,
                    Problem& problem);

} // namespace tandem::simulate
