// SPDX-License-Identifier: MIT
#include "scenes/dynamics.h"

#include "scenes/scene.h"

namespace tandem {

std::optional<MaterialPair> missing_surface(const Materials& materials, std::span<const Body> bodies,
                                            std::span<const BodyDynamics> dynamics) {
    struct Uses {
        std::size_t all = 0, moving = 0;
    };
    std::map<std::uint32_t, Uses> used;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        auto& uses = used[dynamics[i].material];
        ++uses.all;
        if (!bodies[i].fixed) ++uses.moving;
    }
    for (const auto& [a, uses_a] : used) {
        if (uses_a.moving == 0) continue;
        for (const auto& [b, uses_b] : used) {
            const bool can_touch = a != b || uses_a.all > 1;
            if (can_touch && !materials.surfaces.contains({a, b})) return MaterialPair(a, b);
        }
    }
    return {};
}

} // namespace tandem
