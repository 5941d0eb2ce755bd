// SPDX-License-Identifier: MIT
// Scenes of two frames in which only intended pairs of bodies may meet.
#pragma once

#include "scenes/hard/maker.h"

namespace tandem::hard {

/// Pairs of bodies in such a scene. Each pair is a group of bodies of its own, so that 32 are possible.
constexpr std::uint32_t pairs_apart = 16;

/// Whether pair number `index` meets on the way; the others miss each other.
constexpr bool meets_on_the_way(std::uint32_t index) { return index % 2 == 0; }

/// Number of pairs that meet on the way, at every difficulty.
std::uint64_t half_of_pairs_apart(double difficulty);

/// Corners of a tetrahedron in both frames.
using MovingCorners = std::array<Corners, 2>;

/// Deformable bodies of one tetrahedron each, in pairs 2 i and 2 i + 1 that may meet only each other. Corners
/// are put into random order, and the axes of each pair into random order and direction. Every coordinate
/// must be exact in float.
Scene moving_pairs(Random& random, const std::vector<std::array<MovingCorners, 2>>& pairs);

/// Two rigid bodies of one tetrahedron each.
struct TurningCorners {
    Corners a, b;             ///< in their meshes; exact in float
    std::array<Pose, 2> from; ///< of a and b in frame 0
    std::array<Pose, 2> to;   ///< in frame 1
};

/// The same for rigid bodies, with a random translation of each pair that changes from frame to frame.
Scene turning_pairs(Random& random, const std::vector<TurningCorners>& pairs);

} // namespace tandem::hard
