// SPDX-License-Identifier: MIT
// Cost models of the kernels in pack_frame.cl that a frame in the host's memory needs.
#include "algorithms/bodies/cost.h"

namespace tandem {

std::vector<KernelCost> body_costs(const SceneFacts& scene) {
    constexpr double row = 7 * sizeof(double);
    return {{"pack_unit_poses", [=](const FrameFacts&) { return scene.bodies * (row + scene.pose_bytes); },
             no_operations, "seven doubles a body in, poses out"}};
}

} // namespace tandem
