// SPDX-License-Identifier: MIT
#include "scenes/assembly.h"
#include "scenes/builtin.h"
#include "scenes/shapes.h"

namespace tandem {

namespace {

constexpr double small = 0.75;        ///< height of a falling glass, m
constexpr double glass_spacing = 0.1; ///< gap between falling glasses, m

Scene make_glasses(std::span<const SceneParameter> parameters) {
    Assembly assembly(parameters);
    assembly.dynamics = masonry::dynamics();
    const auto bodies = integer_parameter(parameters, "bodies", 1, 1000000);
    const double size = real_parameter(parameters, "size", 0.5, 1e3);
    const auto glass = built_in_mesh("glass");
    const auto large = assembly.add_mesh(scaled(glass, Eigen::Vector3d::Constant(size)));
    const auto falling = assembly.add_mesh(scaled(glass, Eigen::Vector3d::Constant(small)));
    assembly.add_ground(1.25 * size, masonry::ground);
    assembly.add(large, {.pose = {.translation = {0, 0.5 * size, 0}}, .fixed = true});
    assembly.check_memory(bodies, falling);
    // The paper's block begins half a metre lower, which would overlap the rim of this glass.
    for (const auto& centre : block(bodies, small + glass_spacing, size))
        assembly.add(falling, {.pose = {.translation = centre}});
    return assembly.finish();
}

} // namespace

SceneKind glasses_kind() {
    return {
        "glasses",
        "the paper's Glasses: a block of upright goblets falls into a large one that stands on the ground; "
        "glass is modelled as rigid stone and does not break",
        {{"bodies", "2000", "falling glasses, without the ground and the large glass"},
         {"size", "16", "height of the large glass, m; a falling one has 0.75"},
         refine_parameter()},
        make_glasses};
}

} // namespace tandem
