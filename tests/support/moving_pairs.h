// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/meet_in_motion.h"
#include "tests/support/oracle_touch.h"

namespace tandem::support {

/// Two tetrahedra whose corners move on straight lines.
struct MovingPair {
    MovingTetra a, b;
};

inline MovingTetra straight(const TetraCorners& from, const TetraCorners& to) {
    return {.from = from, .to = to};
}

/// Calls change(corner) for every corner of both at both ends.
template<class Change>
MovingPair changed(MovingPair pair, Change change) {
    for (auto* moving : {&pair.a, &pair.b})
        for (auto* corners : {&moving->from, &moving->to})
            for (auto& corner : *corners) corner = change(corner);
    return pair;
}

/// The same tetrahedra with their corners in another order, equal at both ends.
inline MovingPair shuffled(MovingPair pair, Random& random) {
    for (auto* moving : {&pair.a, &pair.b})
        for (unsigned i = 3; i > 0; --i) {
            const auto other = random.next() % (i + 1);
            std::swap(moving->from[i], moving->from[other]);
            std::swap(moving->to[i], moving->to[other]);
        }
    return pair;
}

/// Corners at s = step / steps, times `steps`. Exact for integers that are not too large.
inline TetraCorners at_step(const MovingTetra& moving, int step, int steps) {
    TetraCorners result;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned axis = 0; axis < 3; ++axis)
            result[i][axis] = (steps - step) * moving.from[i][axis] + step * moving.to[i][axis];
    return result;
}

/// Whether the static exact decision finds a common point at one of steps + 1 times.
inline bool meets_at_a_step(const MovingPair& pair, int steps) {
    for (int step = 0; step <= steps; ++step)
        if (relation(at_step(pair.a, step, steps), at_step(pair.b, step, steps)) != Relation::disjoint)
            return true;
    return false;
}

} // namespace tandem::support
