// SPDX-License-Identifier: MIT
#include "scenes/kinds/bars.h"

#include "base/random.h"
#include "scenes/body_memory.h"
#include "scenes/parameters.h"
#include "scenes/refine.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::size_t rise = 100; ///< steps of 0.01 s from rest to the tightest frame
constexpr int parts = 8;          ///< chords between two sections of a line

/// World vertices of a bar. Section i is that of the vertices with x = i * spacing.
std::vector<Eigen::Vector3d> bent(const std::vector<Eigen::Vector3d>& bar,
                                  const std::vector<Section>& sections, double spacing,
                                  const Eigen::Vector3d& offset) {
    std::vector<Eigen::Vector3d> world;
    world.reserve(bar.size());
    for (const auto& p : bar) {
        const auto& section = sections[static_cast<std::size_t>(p.x() / spacing)];
        const Eigen::Vector3d across = p.y() * section.along_y + p.z() * section.along_z;
        world.emplace_back((section.centre + across) + offset);
    }
    return world;
}

/// How far the motion has come in frame `step`.
double amount_at(std::size_t step) {
    const auto phase = step % (2 * rise);
    const double t = static_cast<double>(phase < rise ? phase : 2 * rise - phase) / rise;
    return t * t * (3 - 2 * t);
}

} // namespace

Mesh bar(const std::string& name, const CubeCounts& counts) {
    auto mesh = cubes(name, counts);
    const double height = 0.5 * static_cast<double>(counts[1]), width = 0.5 * static_cast<double>(counts[2]);
    for (auto& v : mesh.vertices)
        v = {bar_edge * v.x(), bar_edge * (v.y() - height), bar_edge * (v.z() - width)};
    complete_mesh(mesh, name);
    return mesh;
}

std::vector<Section> plane_line(std::size_t count, double spacing, double drift,
                                const std::function<double(double)>& slope) {
    std::vector<Section> sections;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    const double chord = spacing / parts;
    for (std::size_t i = 0; i < count; ++i) {
        const double length = spacing * static_cast<double>(i);
        const auto normal = sine_cosine(slope(length));
        sections.push_back({centre, {-normal.sine, normal.cosine, 0}, {0, 0, 1}});
        for (int part = 0; part < parts; ++part) {
            const auto along = sine_cosine(slope(length + (part + 0.5) * chord));
            centre += Eigen::Vector3d(chord * along.cosine, chord * along.sine, 0);
        }
        centre.z() = drift * (length + spacing);
    }
    return sections;
}

Scene scene_of(const Bars& bars, const Mesh& bar, std::span<const SceneParameter> parameters) {
    Scene scene;
    scene.frame_count = integer_parameter(parameters, "frames", 1, 1000000);
    const auto levels = refine_value(parameters);
    refuse_bodies_beyond_memory(bars.count, bar, levels);
    scene.meshes.push_back(refined(bar, levels));
    scene.bodies.assign(bars.count, Body{.mesh = 0, .fixed = false, .deformable = true});
    const double spacing = bar_edge / static_cast<double>(1u << levels);
    double end = 0;
    for (const auto& p : bar.vertices) end = std::max(end, p.x());
    const auto sections = static_cast<std::size_t>(end / spacing) + 1;
    scene.frame = [bars, spacing, sections, rest = scene.meshes.front().vertices](std::size_t step) {
        Frame frame;
        frame.poses.resize(bars.count);
        for (std::size_t body = 0; body < bars.count; ++body)
            frame.deformed.push_back(
                bent(rest, bars.line(sections, spacing, amount_at(step), body), spacing, bars.offset(body)));
        return frame;
    };
    return scene;
}

} // namespace tandem
