// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/simulate/motion_state.h"

#include <cstddef>
#include <span>

namespace tandem::simulate {

/// Where a run is in time.
struct Clock {
    std::uint64_t steps = 0;  ///< done
    double time = 0;          ///< s
    double length = 0;        ///< s, of the next step
    std::uint64_t passes = 0; ///< steps in a row whose length passed at once
};

/// Motion and clock as bytes in the machine's own byte order, headed by a version and the scene's digest.
std::vector<std::byte> to_bytes(const Model& model, const Motion& motion, const Clock& clock);

/// Back again. Throws InputError when the bytes are of another version, byte order or scene, or their number
/// is not what the scene needs.
void from_bytes(const Model& model, std::span<const std::byte> bytes, Motion& motion, Clock& clock);

} // namespace tandem::simulate
