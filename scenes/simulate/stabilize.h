// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/problem.h"

namespace tandem::simulate {

// Fractions of the smaller body's size, in place of the 0.5, 0.001 and 0.01 m of the paper's configurations,
// so that a scene in other units behaves the same. A fixed body has no say.
constexpr double gap_reduction = 0.5;        ///< part of a penetration that one step takes away
constexpr double tolerated_gap = 0.001;      ///< a penetration below this stays
constexpr double greatest_correction = 0.01; ///< of one step

/// Size that penetrations of a pair are measured by, m: of the smaller body that moves.
double pair_size(const Model& model, const Pair& pair);

/// Velocity (m/s, <= 0) added to a normal row so that a step of `time` lessens the penetration.
double separation_bias(double depth, double size, double time);

/// m, how deep bodies that rest are to lie in each other: contact_layer of the smaller body's size, more of
/// small ones; 0 without.
double layer_of(const Model& model, const Pair& pair, double time);

/// Velocity (m/s, >= 0) at which a contact less deep than `layer` (m) may still close: bodies that touch
/// exactly would lose some of their contacts by rounding from step to step, and fall over the others; those
/// that lie in each other by more than rounding keep them (Smith, "Open Dynamics Engine user guide", 2006,
/// contact surface layer).
double settling(double depth, double layer, double time);

/// Moves positions so that penetrations of rigid bodies left after the step lessen; no velocity changes. The
/// same contacts without friction, solved for displacements. `motion` is at the end of the step, `half` its
/// second part (s).
/// Returns what it adds to the potential energy, J.
double correct_positions(const Model& model, Problem problem, std::span<const ContactPoint> contacts,
                         double half, Motion& motion);

} // namespace tandem::simulate
