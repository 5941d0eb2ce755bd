// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/motion_state.h"

#include <cstddef>
#include <span>

namespace tandem::simulate {

/// Progress of a run in time.
struct Clock {
    std::uint64_t steps = 0;  ///< completed steps
    double time = 0;          ///< s
    double length = 0;        ///< s, length of the next step
    std::uint64_t passes = 0; ///< consecutive steps that passed at their first length
};

/// Serialises motion and clock in the machine's byte order, after a version and the scene's digest.
std::vector<std::byte> to_bytes(const Model& model, const MotionState& motion, const Clock& clock);

/// Reads the output of to_bytes. Throws InputError when version, byte order, scene or size differ; `motion`
/// and `clock` are then unchanged.
void from_bytes(const Model& model, std::span<const std::byte> bytes, MotionState& motion, Clock& clock);

} // namespace tandem::simulate
