// SPDX-License-Identifier: MIT
#include "scenes/export/glb_animation.h"

#include "scenes/export/world.h"

#include <algorithm>
#include <functional>

namespace tandem::exporting {

namespace {

using Json = nlohmann::json;

/// The keys of one rigid body.
struct Track {
    std::vector<float> translations, rotations;
    Eigen::Quaterniond last = Eigen::Quaterniond::Identity();

    /// q and -q are the same rotation. Adjacent keys of equal sign make viewers interpolate the shorter
    /// rotation.
    void add(const Pose& pose) {
        last.coeffs() =
            last.coeffs().dot(pose.rotation.coeffs()) < 0 ? -pose.rotation.coeffs() : pose.rotation.coeffs();
        for (const double x : pose.translation) translations.push_back(static_cast<float>(x));
        for (const double x : last.coeffs()) rotations.push_back(static_cast<float>(x));
    }
};

/// The surface of one deformable body. A target has the displacement of each point from the first frame.
struct Morph {
    BoundarySurface surface;
    std::vector<float> first;
    Json targets = Json::array();

    void add(GlbFile& file, const std::vector<Eigen::Vector3d>& vertices) {
        auto points = points_of(surface, vertices);
        if (first.empty()) {
            first = std::move(points);
            return;
        }
        for (std::size_t i = 0; i < points.size(); ++i) points[i] -= first[i];
        targets.push_back({{"POSITION", file.floats(points, 3)}});
    }
};

/// Times (s) of the frames since the first. glTF requires strictly ascending times; close times can be equal
/// in float, so that equal intervals replace them.
std::vector<float> key_times(const Scene& scene, std::span<const std::size_t> frames) {
    std::vector<float> scene_times, even_times;
    for (const auto i : frames) {
        constexpr float frames_per_second = 25;
        even_times.push_back(static_cast<float>(even_times.size()) / frames_per_second);
        if (scene.time) scene_times.push_back(static_cast<float>(scene.time(i) - scene.time(frames[0])));
    }
    const bool ascending = std::adjacent_find(scene_times.begin(), scene_times.end(), std::greater_equal<>())
                           == scene_times.end();
    return scene.time && ascending ? scene_times : even_times;
}

/// One row a key. The first key has no target; each later key has only its own target.
std::vector<float> key_weights(std::size_t keys) {
    std::vector<float> weights(keys * (keys - 1));
    for (std::size_t key = 1; key < keys; ++key) weights[key * (keys - 1) + key - 1] = 1;
    return weights;
}

/// An animation whose channels use the times of one accessor.
struct Channels {
    GlbFile& file;
    std::vector<float> key_times;
    std::size_t times = file.floats(key_times, 1);
    Json animation = {{"channels", Json::array()}, {"samplers", Json::array()}};

    void add(std::size_t values, std::size_t node, const char* path) {
        animation["channels"].push_back(
            {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
        animation["samplers"].push_back({{"input", times}, {"output", values}, {"interpolation", "LINEAR"}});
    }

    /// Shows a node from the time of a frame to that of the next. A scale of 0 hides it (glTF 2.0, section
    /// 3.5.2).
    void show(std::size_t node, std::size_t frame) {
        std::vector<float> own_times, scales;
        for (const std::size_t key : {std::size_t{0}, frame, frame + 1}) {
            if (key == key_times.size() || (!own_times.empty() && own_times.back() == key_times[key]))
                continue;
            own_times.push_back(key_times[key]);
            scales.insert(scales.end(), 3, key == frame ? 1.0f : 0.0f);
        }
        add(file.floats(scales, 3), node, "scale");
        auto& sampler = animation["samplers"].back();
        sampler["input"] = file.floats(own_times, 1);
        sampler["interpolation"] = "STEP";
    }
};

void add_targets(Json& json, std::size_t node, const Morph& morph) {
    auto& mesh = json["meshes"][json["nodes"][node]["mesh"].get<std::size_t>()];
    mesh["weights"] = std::vector<double>(morph.targets.size(), 0.0);
    mesh["primitives"][0]["targets"] = morph.targets;
}

} // namespace

void add_animation(GlbFile& file, const Scene& scene, std::span<const std::size_t> frames,
                   std::span<const std::optional<std::size_t>> shown) {
    std::vector<Track> tracks(scene.bodies.size());
    std::vector<Morph> morphs(scene.bodies.size());
    bool deforms = false;
    for (std::size_t body = 0; body < morphs.size(); ++body) {
        if (!scene.bodies[body].deformable) continue;
        morphs[body].surface = surface_of(scene.meshes[scene.bodies[body].mesh]);
        deforms = true;
    }
    for (const auto i : frames) {
        const auto frame = scene.frame(i);
        for (std::size_t body = 0; body < tracks.size(); ++body) {
            if (scene.bodies[body].deformable)
                morphs[body].add(file, frame.deformed[body]);
            else if (!scene.bodies[body].fixed)
                tracks[body].add(frame.poses[body]);
        }
    }
    Channels channels{file, key_times(scene, frames)};
    const auto weights = deforms ? file.floats(key_weights(frames.size()), 1) : 0;
    for (std::size_t body = 0; body < tracks.size(); ++body) {
        if (scene.bodies[body].deformable) {
            add_targets(file.json(), body, morphs[body]);
            channels.add(weights, body, "weights");
        } else if (!scene.bodies[body].fixed) {
            channels.add(file.floats(tracks[body].translations, 3), body, "translation");
            channels.add(file.floats(tracks[body].rotations, 4), body, "rotation");
        }
    }
    for (std::size_t i = 0; i < shown.size(); ++i)
        if (shown[i]) channels.show(*shown[i], i);
    if (!channels.animation["channels"].empty()) file.add("animations", std::move(channels.animation));
}

std::uint64_t animation_bytes(const Scene& scene, std::size_t frames) {
    std::uint64_t a_frame = 0;
    bool deforms = false;
    for (const auto& body : scene.bodies) {
        if (body.deformable)
            a_frame += surface_of(scene.meshes[body.mesh]).vertices.size() * 3 * sizeof(float);
        else if (!body.fixed)
            a_frame += 7 * sizeof(float);
        deforms = deforms || body.deformable;
    }
    return frames * (a_frame + (deforms ? frames * sizeof(float) : 0));
}

} // namespace tandem::exporting
