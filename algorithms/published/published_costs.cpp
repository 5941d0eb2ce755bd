// SPDX-License-Identifier: MIT
// Cost floor of transform.cl.
#include "algorithms/bodies/cost.h"

namespace tandem {

std::vector<KernelCost> published_costs(const SceneFacts& scene) {
    constexpr double reals = 4; // per vertex
    return {{"transform_vertices",
             [=](const FrameFacts&) {
                 return scene.vertex_rows * (2 * reals * scene.real + 4) + scene.bodies * scene.pose_bytes;
             },
             no_operations, "reads vertices, their bodies and poses, writes vertices"}};
}

} // namespace tandem
