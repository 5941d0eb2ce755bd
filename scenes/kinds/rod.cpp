// SPDX-License-Identifier: MIT
#include "scenes/kinds/bars.h"
#include "scenes/parameters.h"
#include "base/random.h"

#include <numbers>
#include <cmath>

namespace tandem {

namespace {

using std::numbers::pi;
constexpr double bend = 2;           ///< radius of the tightest coil, in thicknesses
constexpr double rod_distance = 4.9; ///< between the axes of rods in thicknesses: the tightest coils overlap

/// Form of a coil around the y-axis whose number of turns stays: `turn` radians a metre of the rod. `rise` is
/// the cosine of the angle between rod and axis: 1 of a straight rod, 0 of a flat ring.
struct Coil {
    double turn, rise;
    double twist; ///< of the cross-section, radians a metre
};

/// Cross-section after the length s of the rod. The directions are those of the coil's normal and binormal,
/// turned back by the coil's own torsion and forth by the twist.
Section section_at(const Coil& coil, double s) {
    const double slant = std::sqrt(1 - coil.rise * coil.rise);
    const auto around = sine_cosine(coil.turn * s);
    const Eigen::Vector3d normal(-around.cosine, 0, -around.sine);
    const Eigen::Vector3d binormal(-coil.rise * around.sine, -slant, coil.rise * around.cosine);
    const auto own = sine_cosine((coil.twist + coil.turn * coil.rise) * s);
    const double radius = slant / coil.turn;
    return {{radius * around.cosine, coil.rise * s, radius * around.sine},
            own.cosine * normal + own.sine * binormal,
            own.cosine * binormal - own.sine * normal};
}

Scene make_rod(std::span<const SceneParameter> parameters) {
    const auto length = integer_parameter(parameters, "length", 1, 100000);
    const auto width = integer_parameter(parameters, "width", 1, 64);
    const double thickness = bar_edge * static_cast<double>(width);
    const double twist = real_parameter(parameters, "twist", -1, 1) / thickness;
    const double turn = 1 / (bend * thickness);
    const double least = real_parameter(parameters, "pitch", 0, 8) * thickness * turn / (2 * pi);
    const Bars bars{.count = integer_parameter(parameters, "count", 1, 100000),
                    .line =
                        [=](std::size_t sections, double spacing, double amount, std::size_t) {
                            const Coil coil{turn, 1 - (1 - least) * amount, twist * amount};
                            std::vector<Section> line;
                            for (std::size_t i = 0; i < sections; ++i)
                                line.push_back(section_at(coil, spacing * static_cast<double>(i)));
                            return line;
                        },
                    .offset =
                        [=](std::size_t body) {
                            return Eigen::Vector3d(rod_distance * thickness * static_cast<double>(body), 0,
                                                   0);
                        }};
    return scene_of(bars, bar("rod", {length, width, width}), parameters);
}

} // namespace

SceneKind rod_kind() {
    return {"rod",
            "deformable rods that twist and coil up by script until neighbouring turns overlap, then uncoil; "
            "coils side by side overlap a little",
            {{"count", "1", "rods"},
             {"length", "240", "cubes of 0.25 m along a rod"},
             {"width", "3", "cubes across it"},
             {"twist", "0.3", "radians that a thickness of the rod twists in the tightest frame"},
             {"pitch", "0.8", "distance of turns in the tightest frame, in thicknesses"},
             {"frames", "200", "steps of 0.01 s"},
             refine_parameter()},
            make_rod};
}

} // namespace tandem
