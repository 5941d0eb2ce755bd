// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"

namespace tandem {

/// A tetrahedron that moves from time s = 0 to s = 1. The path of corner i is
/// (1 - s) from[i] + s to[i] + bend(s), where bend is how far the arc of a rotation leaves its chord:
/// (cos(s angle) - 1 + s (1 - cos angle)) across[i] + (sin(s angle) - s sin angle) along[i].
struct MovingTetra {
    TetraCorners from{}, to{}; ///< exact positions at both ends
    double angle = 0;          ///< of the rotation, from 0 to pi; 0: every corner moves on a straight line
    /// Corners at s = 0 relative to the axis of rotation, and perpendicular to it; unused with angle 0.
    TetraCorners across{};
    TetraCorners along{}; ///< the axis times `across`, of equal lengths
    double off = 0;       ///< error bound of every coordinate of bend(s)
};

/// Whether two moving tetrahedra have a common point at some time from 0 to 1. Sets are closed, as in
/// `Relation`.
enum class Meeting : std::uint8_t {
    apart,     ///< at no time
    meeting,   ///< at some time
    undecided, ///< neither is certain; only for paths with an arc
    invalid    ///< a coordinate is not finite
};

/// The test that decided, cheapest first.
enum class MeetingTier : std::uint8_t {
    ends,       ///< exact relation at s = 0 and s = 1
    intervals,  ///< separating axes over intervals of time, or an overlap at one time; in double
    polynomials ///< signs of integer polynomials at their roots; only for straight paths
};
constexpr unsigned meeting_tier_count = 3;

struct MeetingDecision {
    Meeting meeting = Meeting::invalid;
    MeetingTier tier = MeetingTier::ends;

    bool operator==(const MeetingDecision&) const = default;
};

/// Decides a pair. Exact for straight paths. With an arc, `undecided` remains for pairs that touch on their
/// way without an overlap, or are nearer than rounding. `first` skips cheaper tiers after the ends, so that
/// tests can force the last one.
MeetingDecision meet_in_motion(const MovingTetra& a, const MovingTetra& b,
                               MeetingTier first = MeetingTier::ends);

} // namespace tandem
