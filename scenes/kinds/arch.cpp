// SPDX-License-Identifier: MIT
#include "scenes/kinds/arches.h"

namespace tandem {

namespace {

Scene make_arch(std::span<const SceneParameter> parameters) {
    Assembly assembly(parameters);
    assembly.dynamics = masonry::dynamics();
    const double radius = real_parameter(parameters, "radius", 0.01, 50);
    const double thickness = real_parameter(parameters, "thickness", 0.01, 0.99);
    const ArchShape shape{.outer = radius,
                          .inner = (1 - thickness) * radius,
                          .depth = real_parameter(parameters, "depth", 0.01, 50),
                          .stones = integer_parameter(parameters, "stones", 3, 101),
                          .segments = integer_parameter(parameters, "segments", 1, 100)};
    assembly.add_ground(4 * radius + 2 * shape.depth, masonry::ground);
    Arch(assembly, shape).place(assembly, 0, 0, 0, 0, integer_parameter(parameters, "keystone", 0, 1) == 1);
    return assembly.finish();
}

} // namespace

SceneKind arch_kind() {
    return {"arch",
            "one arch of the colosseum on its pillars; with keystone=0 it collapses; no mortar, nothing "
            "breaks",
            {{"radius", "1.3", "outer radius and height of the pillars, m"},
             {"thickness", "0.4", "thickness of stones and pillars, fraction of the radius"},
             {"depth", "0.8", "depth, m"},
             {"stones", "7", "stones of the arch, odd"},
             {"segments", "5", "boxes of a pillar"},
             {"keystone", "1", "0 leaves out the keystone"},
             refine_parameter()},
            make_arch};
}

} // namespace tandem
