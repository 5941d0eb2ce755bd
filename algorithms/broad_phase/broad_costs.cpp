// SPDX-License-Identifier: MIT
// Cost models of the kernels in broad.cl.
#include "algorithms/bodies/cost.h"

namespace tandem {

std::vector<KernelCost> broad_costs(const SceneFacts& scene) {
    return {{"bound_tiles", [=](const FrameFacts&) { return scene.bodies * (2 * scene.dop() + 4); },
             [=](const FrameFacts&) { return scene.bodies * scene.k; },
             "volumes of bodies in, the same in their order out; k a body for unions"},
            {"find_body_pairs",
             [=](const FrameFacts& f) { return scene.bodies * scene.dop() + 8 * f.body_pairs; },
             [=](const FrameFacts& f) { return scene.k * f.body_pairs; },
             "volumes of bodies in, body pairs out; k a body pair found, none for those that are not"}};
}

} // namespace tandem
