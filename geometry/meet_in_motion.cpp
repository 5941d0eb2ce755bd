// SPDX-License-Identifier: MIT
#include "geometry/meet_in_motion.h"

#include "geometry/intervals.h"
#include "geometry/straight_paths.h"

#include <cmath>

namespace tandem {

namespace {

using namespace geometry;

/// After 26 halvings an arc of 180 degrees is nearer to its chords than rounding.
constexpr IntervalLimits arc_limits{26, 1024};
/// Polynomials take as long as a few hundred intervals.
constexpr IntervalLimits straight_limits{8, 16};

bool is_valid(const MovingTetra& moving) {
    return all_finite(moving.from) && all_finite(moving.to) && all_finite(moving.across)
           && all_finite(moving.along) && std::isfinite(moving.angle) && std::isfinite(moving.off);
}

} // namespace

MeetingDecision meet_in_motion(const MovingTetra& a, const MovingTetra& b, MeetingTier first) {
    if (!is_valid(a) || !is_valid(b)) return {Meeting::invalid, MeetingTier::ends};
    if (relation(a.from, b.from) != Relation::disjoint || relation(a.to, b.to) != Relation::disjoint)
        return {Meeting::meeting, MeetingTier::ends};
    const bool straight = a.angle == 0 && b.angle == 0;
    if (first <= MeetingTier::intervals || !straight) {
        const auto found = meet_by_intervals(a, b, straight ? straight_limits : arc_limits);
        if (found != Meeting::undecided || !straight) return {found, MeetingTier::intervals};
    }
    const bool met = meet_on_straight_paths(a, b);
    return {met ? Meeting::meeting : Meeting::apart, MeetingTier::polynomials};
}

} // namespace tandem
