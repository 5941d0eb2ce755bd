// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

namespace tandem {

/// Bound on the distance between a point that a rotation moves and the straight path between its ends, at
/// equal times, for a point at distance 1 from the origin: 1 - cos(theta / 2), where theta is the angle of
/// the shorter rotation between the poses at constant speed. It is rounded up, and 0 for equal rotations.
/// Proof: bounds/motion.md, theorem 7. Its operations are those of pack_frame.cl.
double arc_between(const Pose& from, const Pose& to);

} // namespace tandem
