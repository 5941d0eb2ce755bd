// SPDX-License-Identifier: MIT
#include "scenes/assembly.h"
#include "scenes/builtin.h"
#include "base/error.h"
#include "base/random.h"
#include "scenes/shapes.h"

#include <numbers>

namespace tandem {

namespace {

using std::numbers::pi;
constexpr double beam_width = 1.9, beam_depth = 4; ///< sizes of the mesh, whose height is 1

std::vector<std::uint32_t> end_vertices(const Mesh& mesh) {
    std::vector<std::uint32_t> end;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
        if (mesh.vertices[v].z() == 0.5 * beam_depth) end.push_back(v);
    return end;
}

/// Settings of the paper's adaptive run: 30 s in steps of a thirtieth of a second.
StepSettings stepping(bool couple) {
    auto result = measured_stepping();
    result.step = 0.033;
    result.adaptive_tolerance = 1e-5;
    result.couple_contacts = couple;
    return result;
}

Scene make_tower(std::span<const SceneParameter> parameters) {
    Assembly assembly(parameters);
    auto& dynamics = assembly.dynamics;
    const auto segments = integer_parameter(parameters, "segments", 1, 10000);
    const auto slices = integer_parameter(parameters, "slices", 3, 1000);
    const double radius = real_parameter(parameters, "radius", 0.1, 1e3);
    const double width = beam_width * radius * sine_cosine(pi / static_cast<double>(slices)).sine;
    const auto beam = assembly.add_mesh(scaled(built_in_mesh("beam"), {width / beam_width, 1, 1}));
    dynamics.materials = {.names = {"rubber"}, .densities = {10}, .surfaces = {{{0, 0}, {0.5, 0}}}};
    dynamics.elastics = {{.law = Elastic::Law::corotational,
                          .young = 15000,
                          .poisson = 0.4,
                          .damping = 0.01,
                          .pinned = end_vertices(assembly.mesh(beam))}};
    dynamics.stepping = stepping(integer_parameter(parameters, "couple", 0, 1) == 1);
    dynamics.solver = measured_solver();
    dynamics.steps = 909;
    const double centre = radius + 0.5 * beam_depth;
    for (std::uint64_t row = 0; row < segments; ++row)
        for (std::uint64_t i = 0; i < slices; ++i) {
            const double position = static_cast<double>(i) + (row % 2 == 1 ? 0.5 : 0.0);
            const double angle = 2 * pi * position / static_cast<double>(slices);
            const auto direction = sine_cosine(angle);
            assembly.add_deformable(
                beam, angle,
                {centre * direction.sine, static_cast<double>(row) + 0.5, centre * direction.cosine}, 0);
        }
    return assembly.finish();
}

} // namespace

SceneKind tower_kind() {
    return {
        "tower",
        "the paper's Tower: rows of soft beams held at their outer ends sag onto each other; corotational "
        "elasticity; contacts exert forces only with couple=1; no plasticity, no contact of a beam "
        "with "
        "itself",
        {{"segments", "4", "stacked rows of beams"},
         {"slices", "6", "beams in a row"},
         {"radius", "2", "radius of the free middle, m; beams are 4 m long"},
         {"couple", "0", "1: contacts exert forces"},
         refine_parameter()},
        make_tower};
}

} // namespace tandem
