// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/meet_in_motion.h"

namespace tandem::geometry {

/// Limits of the search.
struct IntervalLimits {
    unsigned depth = 0;     ///< halvings of [0, 1]
    std::size_t widest = 0; ///< intervals of one length that are still open
};

/// Decides by intervals of time, in double with certified bounds. An overlap at the middle of an interval
/// decides `meeting`. Each interval without a separating axis is halved, and none left decides `apart`.
/// Beyond the limits the result is `undecided`. Coordinates must be finite.
///
/// An axis separates over [s0, s1] when its gap at both ends exceeds the error bounds and what arcs add. Gaps
/// of two corners are linear on chords. A path with |x''| <= angle^2 r is at most angle^2 r (s1 - s0)^2 / 8
/// from its chord at equal times, which is the error of linear interpolation.
Meeting meet_by_intervals(const MovingTetra& a, const MovingTetra& b, const IntervalLimits& limits);

} // namespace tandem::geometry
