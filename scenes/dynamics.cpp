// SPDX-License-Identifier: MIT
#include "scenes/dynamics.h"

#include "scenes/scene.h"

namespace tandem {

std::optional<MaterialPair> missing_surface(const Materials& materials, std::span<const Body> bodies,
                                            std::span<const BodyDynamics> moves) {
    struct Uses {
        std::size_t all = 0, moving = 0;
    };
    std::map<std::uint32_t, Uses> used;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        auto& uses = used[moves[i].material];
        ++uses.all;
        if (!bodies[i].fixed) ++uses.moving;
    }
    for (const auto& [a, of_a] : used) {
        if (of_a.moving == 0) continue;
        for (const auto& [b, of_b] : used) {
            const bool meet = a != b || of_a.all > 1;
            if (meet && !materials.surfaces.contains({a, b})) return MaterialPair(a, b);
        }
    }
    return {};
}

} // namespace tandem
