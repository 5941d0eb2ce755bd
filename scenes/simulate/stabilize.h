// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/problem.h"

namespace tandem::simulate {

// Fractions of pair_size(). The paper's configurations have 0.5, 0.001 m and 0.01 m; fractions give the same
// behaviour in other units.
constexpr double gap_reduction = 0.5;        ///< part of a penetration that one step removes
constexpr double tolerated_gap = 0.001;      ///< smaller penetrations are not corrected
constexpr double greatest_correction = 0.01; ///< largest correction in one step

/// Reference length (m) of a pair's penetrations: the size of the smaller body that moves.
double pair_size(const Model& model, const Pair& pair);

/// Velocity (m/s, <= 0) that a normal row adds to reduce the penetration in a step of `time` s.
double separation_bias(double depth, double size, double time);

/// Target penetration (m) of resting bodies: contact_layer times pair_size(), relatively more for small
/// bodies. It is 0 when contact_layer is 0.
double layer_of(const Model& model, const Pair& pair, double time);

/// Velocity (m/s, >= 0) at which a contact shallower than `layer` (m) may close. Bodies that touch exactly
/// lose some contacts by rounding and tip over the rest; bodies that penetrate by more than rounding keep all
/// (Smith, "Open Dynamics Engine user guide", 2006, contact surface layer).
double settling(double depth, double layer, double time);

/// Moves rigid bodies to reduce penetrations that remain after the step; velocities do not change. Solves the
/// same contacts without friction for displacements. `motion` is at the end of the step, `half` is half its
/// length (s). Returns the added potential energy, J.
double correct_positions(const Model& model, Problem problem, std::span<const ContactPoint> contacts,
                         double half, MotionState& motion);

} // namespace tandem::simulate
