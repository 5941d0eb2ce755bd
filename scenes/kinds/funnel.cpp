// SPDX-License-Identifier: MIT
#include "scenes/assembly.h"
#include "scenes/builtin.h"
#include "scenes/shapes.h"

namespace tandem {

namespace {

constexpr double jack_size = 0.9;    ///< m
constexpr double jack_spacing = 0.1; ///< gap between boxes of jacks, m

/// Lengths in units of the funnel's diameter.
struct Layout {
    double centre; ///< height of the funnel's centre above the ground
    double bottom; ///< height of the block of jacks above the ground
    double ground; ///< width of the ground
};

Scene make_funnel(std::span<const SceneParameter> parameters, const Layout& layout) {
    Assembly assembly(parameters);
    assembly.dynamics = masonry::dynamics();
    const auto bodies = integer_parameter(parameters, "bodies", 1, 1000000);
    const double size = real_parameter(parameters, "size", 0.5, 1e3);
    const auto funnel = assembly.add_mesh(scaled(built_in_mesh("funnel"), Eigen::Vector3d::Constant(size)));
    const auto jack = assembly.add_mesh(scaled(built_in_mesh("jack"), Eigen::Vector3d::Constant(jack_size)));
    assembly.add_ground(layout.ground * size, masonry::ground);
    assembly.add(funnel, {.pose = {.translation = {0, layout.centre * size, 0}}, .fixed = true});
    assembly.check_memory(bodies, jack);
    for (const auto& centre : block(bodies, jack_size + jack_spacing, layout.bottom * size))
        assembly.add(jack, {.pose = {.translation = centre}});
    return assembly.finish();
}

} // namespace

SceneKind funnel_kind() {
    return {"funnel",
            "the paper's Funnel: a block of jacks falls into a funnel above the ground and jams; jacks are "
            "rigid, "
            "their start is a regular grid",
            {{"bodies", "2000", "jacks, without the ground and the funnel"},
             {"size", "16", "diameter of the funnel, m; a jack has 0.9"},
             refine_parameter()},
            [](auto parameters) {
                return make_funnel(parameters, {.centre = 15.0 / 16, .bottom = 21.0 / 16, .ground = 2});
            }};
}

SceneKind jacks_kind() {
    return {
        "jacks",
        "the paper's Fig. 1, and with bodies=1000 Fig. 2: jacks jam in a wider, lower funnel; its size "
        "is that "
        "of the interactive variant, which the figures are likely to show; jacks are rigid",
        {{"bodies", "2000", "jacks, without the ground and the funnel"},
         {"size", "20", "diameter of the funnel, m; a jack has 0.9"},
         refine_parameter()},
        [](auto parameters) { return make_funnel(parameters, {.centre = 0.5, .bottom = 1, .ground = 1.5}); }};
}

} // namespace tandem
