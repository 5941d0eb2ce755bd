// SPDX-License-Identifier: MIT
#include "scenes/export/glb.h"

#include "scenes/error.h"
#include "scenes/export/glb_file.h"
#include "scenes/export/world.h"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <map>

namespace tandem {

namespace {

using exporting::GlbFile;
using exporting::Surface;
using Json = nlohmann::json;

/// Colours of bodies in turn (linear RGB), tellable apart by the colour-blind (after Okabe and Ito 2008); the
/// last is for fixed bodies.
constexpr std::array<std::array<double, 3>, 7> colours{{{0.79, 0.35, 0.0},
                                                        {0.09, 0.46, 0.81},
                                                        {0.0, 0.34, 0.17},
                                                        {0.87, 0.77, 0.05},
                                                        {0.67, 0.11, 0.0},
                                                        {0.6, 0.19, 0.38},
                                                        {0.35, 0.35, 0.35}}};

void append(std::vector<float>& out, const Eigen::Vector3d& v) {
    for (const double x : v) out.push_back(static_cast<float>(x));
}

/// The keys of one rigid body over the frames.
struct Track {
    std::vector<float> translations, rotations;
    Eigen::Quaterniond last = Eigen::Quaterniond::Identity();

    /// q and -q turn alike; neighbours of equal sign keep viewers from turning the long way round.
    void add(const Pose& pose) {
        append(translations, pose.translation);
        if (last.coeffs().dot(pose.rotation.coeffs()) < 0)
            last.coeffs() = -pose.rotation.coeffs();
        else
            last = pose.rotation;
        append(rotations, last.vec());
        rotations.push_back(static_cast<float>(last.w()));
    }
};

Json primitive(GlbFile& file, const Surface& surface, const std::vector<Eigen::Vector3d>& vertices) {
    std::vector<float> points;
    for (const auto vertex : surface.vertices) append(points, vertices[vertex]);
    const auto positions = file.floats(points, 3, true);
    return {{"attributes", {{"POSITION", positions}}}, {"indices", file.indices(surface.triangles)}};
}

void add_channel(Json& animation, std::size_t times, std::size_t values, std::size_t node, const char* path) {
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    animation["samplers"].push_back({{"input", times}, {"output", values}, {"interpolation", "LINEAR"}});
}

/// Seconds of frames first..last from the first on. glTF wants them to grow from key to key, which times
/// close together may not do in float.
std::vector<float> key_times(const Scene& scene, std::size_t first, std::size_t last) {
    std::vector<float> own, even;
    for (auto i = first; i <= last; ++i) {
        constexpr double frames_per_second = 25;
        even.push_back(static_cast<float>(static_cast<double>(i - first) / frames_per_second));
        if (scene.time) own.push_back(static_cast<float>(scene.time(i) - scene.time(first)));
    }
    const bool grows = std::adjacent_find(own.begin(), own.end(), std::greater_equal<>()) == own.end();
    return scene.time && grows ? own : even;
}

/// Makes the nodes of a scene in a file.
class Builder {
public:
    Builder(GlbFile& file, const Scene& scene) : file_(file), scene_(scene) {}

    void add_materials();
    void add_nodes(const Frame& frame);
    void add_animation(std::size_t first, std::size_t last);

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

void Builder::add_materials() {
    for (const auto& [r, g, b] : colours)
        file_.add(
            "materials",
            {{"doubleSided", true},
             {"pbrMetallicRoughness",
              {{"baseColorFactor", {r, g, b, 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.8}}}});
}

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
    Json all = Json::array();
    for (std::size_t body = 0; body < scene_.bodies.size(); ++body) {
        Json node = {{"name", fmt::format("body {}", body)}, {"mesh", mesh_of(frame, body)}};
        if (!scene_.bodies[body].deformable) {
            const auto& [q, t] = frame.poses[body];
            node["translation"] = {t.x(), t.y(), t.z()};
            node["rotation"] = {q.x(), q.y(), q.z(), q.w()};
        }
        all.push_back(file_.add("nodes", std::move(node)));
    }
    file_.add("scenes", {{"name", scene_.key}, {"nodes", all}});
    file_.json()["scene"] = 0;
}

void Builder::add_animation(std::size_t first, std::size_t last) {
    std::vector<Track> tracks(scene_.bodies.size());
    for (auto i = first; i <= last; ++i) {
        const auto frame = scene_.frame(i);
        for (std::size_t body = 0; body < tracks.size(); ++body)
            if (!scene_.bodies[body].fixed && !scene_.bodies[body].deformable)
                tracks[body].add(frame.poses[body]);
    }
    const auto times = file_.floats(key_times(scene_, first, last), 1);
    Json animation = {{"channels", Json::array()}, {"samplers", Json::array()}};
    for (std::size_t body = 0; body < tracks.size(); ++body) {
        if (tracks[body].translations.empty()) continue;
        add_channel(animation, times, file_.floats(tracks[body].translations, 3), body, "translation");
        add_channel(animation, times, file_.floats(tracks[body].rotations, 4), body, "rotation");
    }
    if (!animation["channels"].empty()) file_.add("animations", std::move(animation));
}

} // namespace

void write_glb(const std::string& path, const Scene& scene, std::size_t first, std::size_t last) {
    GlbFile file;
    Builder builder(file, scene);
    builder.add_materials();
    builder.add_nodes(scene.frame(first));
    if (last > first) builder.add_animation(first, last);
    const auto bytes = file.finish();
    if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
        throw InputError(fmt::format("{}: would have {} bytes, glTF ends at 4 GiB; export fewer frames", path,
                                     bytes.size()));
    exporting::write_file(path, bytes);
}

} // namespace tandem
