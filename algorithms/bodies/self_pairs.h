// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "scenes/scene.h"

namespace tandem {

/// Whether setting self pairs tetrahedra of this body with each other.
inline bool meets_itself(const Scene& scene, std::uint32_t body, SelfPairs self) {
    if (self == SelfPairs::deformable && !scene.bodies[body].deformable) return false;
    return self != SelfPairs::off && may_meet(scene, body, body);
}

/// An upper bound of the number of body pairs that a session finds in a frame: every two bodies, and every
/// body that meets itself. Pairs that run() is given may be more, because they may repeat.
inline std::uint64_t most_body_pairs(const Scene& scene, SelfPairs self) {
    const std::uint64_t bodies = scene.bodies.size();
    std::uint64_t pairs = bodies == 0 ? 0 : bodies * (bodies - 1) / 2;
    for (std::uint32_t body = 0; body < bodies; ++body) pairs += meets_itself(scene, body, self) ? 1 : 0;
    return pairs;
}

} // namespace tandem
