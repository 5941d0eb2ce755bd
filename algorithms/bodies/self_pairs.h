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

} // namespace tandem
