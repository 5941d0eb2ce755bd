// SPDX-License-Identifier: MIT
#include "scenes/export/glb.h"

#include "base/error.h"
#include "scenes/export/glb_animation.h"
#include "scenes/export/glb_surfaces.h"
#include "scenes/export/world.h"

#include <fmt/format.h>
#include <limits>
#include <map>
#include <numeric>

namespace tandem {

namespace {

using exporting::BoundarySurface;
using exporting::GlbFile;
using Json = nlohmann::json;

/// Colours of consecutive bodies (linear RGB), distinguishable with colour blindness (after Okabe and Ito
/// 2008). The last colour is for fixed bodies.
constexpr std::array<std::array<double, 3>, 7> colours{{{0.79, 0.35, 0.0},
                                                        {0.09, 0.46, 0.81},
                                                        {0.0, 0.34, 0.17},
                                                        {0.87, 0.77, 0.05},
                                                        {0.67, 0.11, 0.0},
                                                        {0.6, 0.19, 0.38},
                                                        {0.35, 0.35, 0.35}}};

constexpr double translucent = 0.2; ///< alpha of bodies around contact surfaces

Json primitive(GlbFile& file, const BoundarySurface& surface, const std::vector<Eigen::Vector3d>& vertices) {
    const auto positions = file.floats(exporting::points_of(surface, vertices), 3, true);
    return {{"attributes", {{"POSITION", positions}}}, {"indices", file.indices(surface.triangles)}};
}

/// Adds materials and nodes of a scene to a file.
class Builder {
public:
    Builder(GlbFile& file, const Scene& scene) : file_(file), scene_(scene) {}

    void add_materials(bool are_translucent);
    void add_nodes(const Frame& frame);
    void add_scene();

private:
    std::size_t mesh_of(const Frame& frame, std::size_t body);
    std::size_t colour_of(std::size_t body) const {
        return scene_.bodies[body].fixed ? colours.size() - 1 : body % (colours.size() - 1);
    }

    GlbFile& file_;
    const Scene& scene_;
    std::map<std::uint32_t, Json> primitives_;                            ///< by mesh of rigid bodies
    std::map<std::pair<std::uint32_t, std::size_t>, std::size_t> meshes_; ///< by mesh and colour
};

void Builder::add_materials(bool are_translucent) {
    const double alpha = are_translucent ? translucent : 1.0;
    for (const auto& [r, g, b] : colours) {
        Json material = {
            {"doubleSided", true},
            {"pbrMetallicRoughness",
             {{"baseColorFactor", {r, g, b, alpha}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.8}}}};
        if (are_translucent) material["alphaMode"] = "BLEND";
        file_.add("materials", std::move(material));
    }
}

/// Rigid bodies of one mesh use the same data, and the same glTF mesh when their colours are equal. A
/// deformable body has its own data.
std::size_t Builder::mesh_of(const Frame& frame, std::size_t body) {
    const auto index = scene_.bodies[body].mesh;
    const auto& mesh = scene_.meshes[index];
    const auto colour = colour_of(body);
    const auto add = [&](Json primitives) {
        primitives["material"] = colour;
        return file_.add("meshes", {{"name", mesh.name}, {"primitives", Json::array({primitives})}});
    };
    if (scene_.bodies[body].deformable)
        return add(primitive(file_, exporting::surface_of(mesh), frame.deformed[body]));
    if (!primitives_.contains(index))
        primitives_[index] = primitive(file_, exporting::surface_of(mesh), mesh.vertices);
    const auto key = std::pair(index, colour);
    if (!meshes_.contains(key)) meshes_[key] = add(primitives_[index]);
    return meshes_[key];
}

void Builder::add_nodes(const Frame& frame) {
    for (std::size_t body = 0; body < scene_.bodies.size(); ++body) {
        Json node = {{"name", fmt::format("body {}", body)}, {"mesh", mesh_of(frame, body)}};
        if (!scene_.bodies[body].deformable) {
            const auto& [q, t] = frame.poses[body];
            node["translation"] = {t.x(), t.y(), t.z()};
            node["rotation"] = {q.x(), q.y(), q.z(), q.w()};
        }
        file_.add("nodes", std::move(node));
    }
}

void Builder::add_scene() {
    std::vector<std::size_t> all(file_.json()["nodes"].size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    file_.add("scenes", {{"name", scene_.key}, {"nodes", all}});
    file_.json()["scene"] = 0;
}

std::vector<SurfaceFrames> all_surfaces(const Scene& scene, std::span<const std::size_t> frames,
                                        const FindSurfaces& find) {
    std::vector<SurfaceFrames> found;
    for (const auto i : frames) found.push_back(find(i, scene.frame(i)));
    return found;
}

} // namespace

std::size_t write_glb(const std::string& path, const Scene& scene, std::span<const std::size_t> frames,
                      const FindSurfaces& surfaces) {
    constexpr auto most = std::numeric_limits<std::uint32_t>::max();
    const auto check = [&](std::uint64_t bytes) {
        if (bytes > most)
            throw InputError(
                fmt::format("{}: would have {} bytes, but glTF allows at most {}; export fewer frames", path,
                            bytes, most));
    };
    // Checked first, since the animation is nearly all of a large file.
    check(exporting::animation_bytes(scene, frames.size()));
    GlbFile file;
    Builder builder(file, scene);
    builder.add_materials(static_cast<bool>(surfaces));
    builder.add_nodes(scene.frame(frames[0]));
    std::vector<std::optional<std::size_t>> nodes;
    std::size_t polygons = 0;
    if (surfaces) {
        const auto found = all_surfaces(scene, frames, surfaces);
        nodes = exporting::add_surfaces(file, found);
        for (const auto& frame : found) polygons += frame.rows.size();
    }
    builder.add_scene();
    if (frames.size() > 1) exporting::add_animation(file, scene, frames, nodes);
    const auto bytes = file.finish();
    check(bytes.size());
    exporting::write_file(path, bytes);
    return polygons;
}

} // namespace tandem
