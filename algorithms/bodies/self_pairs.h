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

/// An upper bound of the number of body pairs that a session finds in a frame: every two bodies of a
/// world, and every body that meets itself. Pairs that run() is given may be more, because they may repeat.
inline std::uint64_t most_body_pairs(const Scene& scene, SelfPairs self) {
    std::uint64_t pairs = 0;
    std::uint64_t before = 0; // bodies of the same world with smaller numbers
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
        if (body > 0 && world_of(scene, body) != world_of(scene, body - 1)) before = 0;
        pairs += before++;
        pairs += meets_itself(scene, body, self) ? 1 : 0;
    }
    return pairs;
}

} // namespace tandem
