// SPDX-License-Identifier: MIT
#include "scenes/export/glb_surfaces.h"

#include "scenes/export/colour_scale.h"

#include <fmt/format.h>

namespace tandem::exporting {

namespace {

using Json = nlohmann::json;

std::size_t add_material(GlbFile& file, double most) {
    return file.add("materials",
                    {{"name", fmt::format("pressure: violet 0, yellow {:.4g}", most)},
                     {"doubleSided", true},
                     {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 1.0}}},
                     {"extras", {{"most_pressure", most}}}});
}

/// Triangles of a frame's polygons, which are convex: each from its first corner.
std::vector<std::uint32_t> triangles_of(const ContactSurfaces& surfaces) {
    std::vector<std::uint32_t> triangles;
    std::uint32_t first = 0;
    for (const auto end : surfaces.ends) {
        for (auto i = first + 2; i < end; ++i) triangles.insert(triangles.end(), {first, i - 1, i});
        first = static_cast<std::uint32_t>(end);
    }
    return triangles;
}

Json surface_primitive(GlbFile& file, const ContactSurfaces& surfaces, double most) {
    std::vector<float> points, colours, pressures;
    for (const auto& corner : surfaces.corners)
        for (const double x : corner) points.push_back(static_cast<float>(x));
    for (const double pressure : surfaces.pressures) {
        pressures.push_back(static_cast<float>(pressure));
        const auto colour = linear_colour(most > 0 ? pressure / most : 0);
        colours.insert(colours.end(), colour.begin(), colour.end());
    }
    return {{"attributes",
             {{"POSITION", file.floats(points, 3, true)},
              {"COLOR_0", file.floats(colours, 3, true)},
              {"_PRESSURE", file.floats(pressures, 1, true)}}},
            {"indices", file.indices(triangles_of(surfaces))}};
}

} // namespace

std::vector<std::optional<std::size_t>> add_surfaces(GlbFile& file, std::span<const SurfaceFrames> frames) {
    double most = 0;
    for (const auto& frame : frames) most = std::max(most, frame.most_pressure());
    const auto material = add_material(file, most);
    std::vector<std::optional<std::size_t>> nodes;
    for (const auto& frame : frames) {
        auto& node = nodes.emplace_back();
        if (frame.rows.empty()) continue;
        auto triangles = surface_primitive(file, frame.surfaces, most);
        triangles["material"] = material;
        const auto mesh = file.add(
            "meshes", {{"name", "contact surfaces"}, {"primitives", Json::array({std::move(triangles)})}});
        Json made = {{"name", fmt::format("contact surfaces of frame {}", frame.frames.front())},
                     {"mesh", mesh}};
        if (nodes.size() > 1) made["scale"] = {0, 0, 0};
        node = file.add("nodes", std::move(made));
    }
    return nodes;
}

} // namespace tandem::exporting
