// SPDX-License-Identifier: MIT
#include "scenes/kinds/arches.h"
#include "scenes/shapes.h"

namespace tandem {

namespace {

Scene make_meteor(std::span<const SceneParameter> parameters) {
    Assembly assembly(parameters);
    auto& dynamics = assembly.dynamics;
    dynamics = masonry::dynamics();
    dynamics.steps = 5000;
    const Amphitheatre shape{.inner = 4,
                             .width = 0.5,
                             .slices = integer_parameter(parameters, "slices", 3, 1000),
                             .layers = integer_parameter(parameters, "layers", 1, 1000)};
    const double speed = real_parameter(parameters, "speed", 0, 1e4);
    const auto ball = assembly.add_mesh(sphere(real_parameter(parameters, "ball", 0.01, 2.5), 12, 12));
    assembly.add_ground(2 * (shape.inner + shape.width) + 2, masonry::ground);
    add_amphitheatre(assembly, shape);
    assembly.add(ball, {.pose = {.translation = {10, 2.5, 0}},
                        .material = masonry::cannonball,
                        .velocity = {-speed, 0, -speed / 6}});
    return assembly.finish();
}

} // namespace

SceneKind meteor_kind() {
    return {"meteor",
            "the paper's Fig. 2, top: an iron ball hits a small building of arches from the side; nothing "
            "breaks, "
            "melts or burns",
            {{"slices", "20", "arches in a layer, 18 bodies each"},
             {"layers", "3", "layers of arches"},
             {"ball", "1.5", "radius, m"},
             {"speed", "90", "speed towards the building, m/s; the sideways speed is a sixth of it"},
             refine_parameter()},
            make_meteor};
}

} // namespace tandem
