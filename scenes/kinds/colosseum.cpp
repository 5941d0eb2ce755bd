// SPDX-License-Identifier: MIT
#include "scenes/kinds/arches.h"

namespace tandem {

namespace {

Scene make_colosseum(std::span<const SceneParameter> parameters) {
    Assembly assembly(parameters);
    assembly.dynamics = masonry::dynamics();
    const Amphitheatre shape{.inner = real_parameter(parameters, "radius", 0.1, 1e3),
                             .width = real_parameter(parameters, "width", 0.01, 1e3),
                             .slices = integer_parameter(parameters, "slices", 3, 1000),
                             .layers = integer_parameter(parameters, "layers", 1, 1000),
                             .keystone = integer_parameter(parameters, "keystone", 0, 1) == 1};
    assembly.add_ground(2 * (shape.inner + 5 * shape.width), masonry::ground);
    add_amphitheatre(assembly, shape);
    return assembly.finish();
}

} // namespace

SceneKind colosseum_kind() {
    return {
        "colosseum",
        "the paper's structure of stones without mortar: layers of arches in a circle on the ground, a ring "
        "of stones on each layer; stones are rigid and do not break",
        {{"slices", "24", "arches in a layer, 18 bodies each"},
         {"layers", "4", "layers of arches"},
         {"radius", "10", "inner radius, m"},
         {"width", "1", "outer minus inner radius, m"},
         {"keystone", "1", "0 leaves out the keystone of one arch, the first of the lowest layer"},
         refine_parameter()},
        make_colosseum};
}

} // namespace tandem
