// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/meet_in_motion.h"
#include "harness/verify/oracle/frame_truth.h"

namespace tandem {

/// The tetrahedra that meet while all bodies move from one frame to the next.
///
/// Time s runs from 0 to 1. x0 and x1 are the vertices of world_vertices() in both frames, in the cell's
/// precision and with its origin, treated as exact. Vertices of deformable bodies move on straight lines,
/// x(s) = (1 - s) x0 + s x1. A vertex p of a rigid body's mesh has
/// x(s) = (1 - s) x0 + s x1 + (R(s) p - ((1 - s) R(0) p + s R(1) p)), where R turns from the first rotation
/// to the second about one axis, the shorter way and at constant speed. R(0) and R(1) are the frames'
/// rotations, normalised in double. When the angle is 180 degrees, within rounding, both ways count. Equal
/// rotations make a straight line.
struct MotionTruth {
    std::vector<Pair> colliding; ///< with a common point at some s; sorted
    std::vector<Pair> undecided; ///< neither meeting nor apart for certain; sorted; none on straight paths
    /// (body, tetrahedron) with a coordinate that is not finite in either frame, sorted; in no pair above.
    std::vector<std::array<std::uint32_t, 2>> invalid;
    std::array<std::uint64_t, meeting_tier_count> tiers{}; ///< number of pairs that each tier decided
};

/// Progress and memory of a truth.
struct TruthOptions {
    Report report{};                          ///< called from the calling thread, unless it is empty
    std::uint64_t memory = ~std::uint64_t{0}; ///< limit of bytes
};

/// Decides every pair of tetrahedra that frame_truth() would decide in either frame: of bodies that
/// may_meet() allows, and with positions.self those of one body that share no vertex. Tetrahedra that either
/// frame skips are in no pair. Pairs that are not listed never meet: only pairs whose boxes over the whole
/// motion are disjoint are not decided. Runs on all cores. Throws InputError when the estimated memory
/// exceeds `memory` bytes.
MotionTruth motion_truth(const Scene& scene, const Frame& from, const Frame& to, Positions positions,
                         const TruthOptions& options = {});

} // namespace tandem
