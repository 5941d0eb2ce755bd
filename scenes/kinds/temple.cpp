// SPDX-License-Identifier: MIT
#include "scenes/assembly.h"
#include "scenes/shapes.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::size_t drum_sides = 12; ///< sides of a drum
constexpr std::size_t shaft = 5;       ///< drums of a shaft
constexpr double pitch_of_width = 2.5; ///< distance of adjacent pillars, in widths of a pillar

/// A grid of pillars, one storey high. Beams are `thickness` wide, stone courses are `course` high.
struct Plan {
    std::uint64_t columns, rows;
    double height, width;

    double pitch() const { return pitch_of_width * width; }
    double thickness() const { return 0.4 * width; }
    double course() const { return halved_on_grid(0.6 * width); }
    double x(std::uint64_t column) const {
        return pitch() * (static_cast<double>(column) - 0.5 * static_cast<double>(columns - 1));
    }
    double z(std::uint64_t row) const {
        return pitch() * (static_cast<double>(row) - 0.5 * static_cast<double>(rows - 1));
    }
};

/// A pillar's meshes from bottom to top, with the heights of their centres.
struct Pillar {
    std::vector<std::uint32_t> meshes;
    std::vector<double> heights;
    double top = 0;

    void add(std::uint32_t mesh, double height) {
        meshes.push_back(mesh);
        heights.push_back(top + 0.5 * height);
        top += height;
    }
};

/// A pillar of plinth, base, tapering shaft, capital and abacus, in the proportions of the paper's code.
Pillar make_pillar(Assembly& assembly, const Plan& plan) {
    Pillar pillar;
    const auto part_height = [&](double fraction) { return halved_on_grid(fraction * plan.height); };
    const double half = 0.5 * plan.width;
    const auto add_drum = [&](double lower, double upper, double height) {
        pillar.add(assembly.add_mesh(drum(drum_sides, lower * half, upper * half, height)), height);
    };
    pillar.add(assembly.add_box({plan.width, part_height(0.06), plan.width}), part_height(0.06));
    add_drum(0.9, 0.9, part_height(0.06));
    for (std::size_t i = 0; i < shaft; ++i) {
        const auto radius = [](std::size_t joint) {
            return 0.8 - 0.2 * static_cast<double>(joint) / static_cast<double>(shaft);
        };
        add_drum(radius(i), radius(i + 1), part_height(0.8 / static_cast<double>(shaft)));
    }
    add_drum(0.6, 0.9, part_height(0.05));
    pillar.add(assembly.add_box({plan.width, part_height(0.03), plan.width}), part_height(0.03));
    return pillar;
}

bool on_perimeter(const Plan& plan, std::uint64_t column, std::uint64_t row) {
    return column == 0 || row == 0 || column + 1 == plan.columns || row + 1 == plan.rows;
}

struct Interval {
    double low, high;

    double length() const { return high - low; }
    double middle() const { return 0.5 * (low + high); }
};

/// Adds a box over a rectangle of the plan.
void add_slab(Assembly& assembly, Interval x, Interval z, double base, double height) {
    assembly.add(assembly.add_box({x.length(), height, z.length()}),
                 {.pose = {.translation = {x.middle(), base + 0.5 * height, z.middle()}}});
}

/// Adds beams between adjacent pillars. Beams along x cover the corners; beams along z begin behind them.
void add_architraves(Assembly& assembly, const Plan& plan, double base) {
    const double half = 0.5 * plan.thickness();
    for (const auto row : {std::uint64_t{0}, plan.rows - 1})
        for (std::uint64_t i = 0; i + 1 < plan.columns; ++i)
            add_slab(assembly,
                     {plan.x(i) - (i == 0 ? 0.5 * plan.width : 0),
                      plan.x(i + 1) + (i + 2 == plan.columns ? 0.5 * plan.width : 0)},
                     {plan.z(row) - half, plan.z(row) + half}, base, plan.course());
    for (const auto column : {std::uint64_t{0}, plan.columns - 1})
        for (std::uint64_t i = 0; i + 1 < plan.rows; ++i)
            add_slab(assembly, {plan.x(column) - half, plan.x(column) + half},
                     {plan.z(i) + (i == 0 ? half : 0), plan.z(i + 1) - (i + 2 == plan.rows ? half : 0)}, base,
                     plan.course());
}

/// Adds slabs side by side across the whole width.
void add_ceiling(Assembly& assembly, const Plan& plan, double base) {
    const double half_width = 0.5 * plan.width - plan.x(0);
    const double half_depth = 0.5 * plan.width - plan.z(0);
    const auto edge = [&](std::uint64_t i) {
        return half_depth * (2 * static_cast<double>(i) / static_cast<double>(plan.rows - 1) - 1);
    };
    for (std::uint64_t i = 0; i + 1 < plan.rows; ++i)
        add_slab(assembly, {-half_width, half_width}, {edge(i), edge(i + 1)}, base,
                 halved_on_grid(0.5 * plan.course()));
}

Scene make_temple(std::span<const SceneParameter> parameters) {
    Assembly assembly(parameters);
    assembly.dynamics = masonry::dynamics();
    const Plan plan{.columns = integer_parameter(parameters, "columns", 2, 1000),
                    .rows = integer_parameter(parameters, "rows", 2, 1000),
                    .height = real_parameter(parameters, "height", 0.1, 1e3),
                    .width = real_parameter(parameters, "width", 0.05, 100)};
    assembly.add_ground(plan.pitch() * static_cast<double>(std::max(plan.columns, plan.rows) + 4),
                        masonry::ground);
    const auto pillar = make_pillar(assembly, plan);
    for (std::uint64_t row = 0; row < plan.rows; ++row)
        for (std::uint64_t column = 0; column < plan.columns; ++column) {
            if (!on_perimeter(plan, column, row)) continue;
            for (std::size_t i = 0; i < pillar.meshes.size(); ++i)
                assembly.add(pillar.meshes[i],
                             {.pose = {.translation = {plan.x(column), pillar.heights[i], plan.z(row)}}});
        }
    add_architraves(assembly, plan, pillar.top);
    add_ceiling(assembly, plan, pillar.top + plan.course());
    return assembly.finish();
}

} // namespace

SceneKind temple_kind() {
    return {"temple",
            "a Greek temple of loose stones: pillars of plinth, drums and capital around a rectangle, "
            "architraves, "
            "a flat ceiling; no gable, no inner walls, no mortar, nothing breaks",
            {{"columns", "6", "pillars along the front"},
             {"rows", "8", "pillars along the side"},
             {"height", "3", "height of a pillar, m"},
             {"width", "0.5", "width of a pillar, m; the distance of pillars is 2.5 widths"},
             refine_parameter()},
            make_temple};
}

} // namespace tandem
