// SPDX-License-Identifier: MIT
#include "scenes/builtin.h"
#include "scenes/digest.h"
#include "scenes/error.h"
#include "scenes/motion.h"
#include "scenes/parameters.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

using Json = nlohmann::json;

/// A place in the description, for messages: "file.json: /bodies/3/pose: ".
struct Place {
    std::string file;
    std::string pointer;

    Place operator/(std::string_view name) const { return {file, fmt::format("{}/{}", pointer, name)}; }
    Place operator/(std::size_t index) const { return {file, fmt::format("{}/{}", pointer, index)}; }
    std::string text() const { return pointer.empty() ? file : fmt::format("{}: {}", file, pointer); }
    [[noreturn]] void fail(std::string_view what) const {
        throw InputError(fmt::format("{}: {}", text(), what));
    }
};

void check_names(const Json& object, const Place& place, const std::vector<std::string>& allowed) {
    if (!object.is_object()) place.fail("must be an object");
    for (const auto& [name, value] : object.items())
        if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
            place.fail(unknown("name", name, allowed));
}

double number(const Json& json, const Place& place) {
    if (!json.is_number() || !std::isfinite(json.get<double>())) place.fail("must be a finite number");
    return json.get<double>();
}

std::string text(const Json& json, const Place& place) {
    if (!json.is_string()) place.fail("must be a string");
    return json.get<std::string>();
}

template<std::size_t N>
std::array<double, N> numbers(const Json& json, const Place& place) {
    if (!json.is_array() || json.size() != N) place.fail(fmt::format("must be {} numbers", N));
    std::array<double, N> values{};
    for (std::size_t i = 0; i < N; ++i) values[i] = number(json[i], place / i);
    return values;
}

Eigen::Vector3d vector(const Json& json, const Place& place) {
    const auto v = numbers<3>(json, place);
    return {v[0], v[1], v[2]};
}

Eigen::Quaterniond quaternion(double w, double x, double y, double z, const Place& place) {
    if (!(w * w + x * x + y * y + z * z > 0)) place.fail("must not be the zero quaternion");
    return unit(Eigen::Quaterniond(w, x, y, z));
}

/// How one body moves: a start, a velocity and a spin per frame, or a list of poses.
struct Motion {
    Pose start;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    double spin = 0;
    std::vector<Pose> poses;

    Pose at(std::size_t frame) const {
        if (!poses.empty()) return poses[frame];
        const auto time = static_cast<double>(frame);
        return {unit(product(turn(axis, spin * time), start.rotation)), start.translation + time * velocity};
    }
};

Mesh read_one(const Json& json, const Place& place, const std::filesystem::path& folder) {
    check_names(json, place, {"builtin", "file", "scale"});
    if (json.contains("builtin") == json.contains("file")) place.fail("must name either a builtin or a file");
    Mesh mesh;
    if (json.contains("builtin")) {
        const auto name = text(json["builtin"], place / "builtin");
        const auto names = built_in_names();
        if (std::find(names.begin(), names.end(), name) == names.end())
            (place / "builtin").fail(unknown("mesh", name, names));
        mesh = built_in_mesh(name);
    } else {
        mesh = read_mesh((folder / text(json["file"], place / "file")).string());
    }
    if (!json.contains("scale")) return mesh;
    const double scale = number(json["scale"], place / "scale");
    if (!(scale > 0)) (place / "scale").fail("must be above 0");
    for (auto& v : mesh.vertices) v *= scale;
    complete_mesh(mesh, place.text());
    return mesh;
}

Motion read_motion(const Json& json, const Place& place, std::size_t frames) {
    Motion motion;
    if (json.contains("position")) motion.start.translation = vector(json["position"], place / "position");
    if (json.contains("rotation")) {
        const auto q = numbers<4>(json["rotation"], place / "rotation");
        motion.start.rotation = quaternion(q[0], q[1], q[2], q[3], place / "rotation");
    }
    if (json.contains("velocity")) motion.velocity = vector(json["velocity"], place / "velocity");
    if (json.contains("spin")) {
        const auto spin = numbers<4>(json["spin"], place / "spin");
        const double length = std::sqrt((spin[0] * spin[0] + spin[1] * spin[1]) + spin[2] * spin[2]);
        if (!(length > 0)) (place / "spin").fail("must have an axis that is not 0");
        motion.axis = {spin[0] / length, spin[1] / length, spin[2] / length};
        motion.spin = spin[3];
        if (!(std::fabs(motion.spin) * static_cast<double>(frames) <= 1e6))
            (place / "spin").fail("must turn by no more than 1e6 radians in all frames together");
    }
    if (!json.contains("poses")) return motion;
    for (const auto* name : {"position", "rotation", "velocity", "spin"})
        if (json.contains(name)) (place / name).fail("is replaced by poses; leave one out");
    if (!json["poses"].is_array() || json["poses"].size() != frames)
        (place / "poses").fail(fmt::format("must be one pose a frame, {} in all", frames));
    for (std::size_t i = 0; i < frames; ++i) {
        const auto p = numbers<7>(json["poses"][i], place / "poses" / i);
        motion.poses.push_back({quaternion(p[3], p[4], p[5], p[6], place / "poses" / i), {p[0], p[1], p[2]}});
    }
    return motion;
}

bool flag(const Json& json, const char* name, const Place& place) {
    if (!json.contains(name)) return false;
    if (!json[name].is_boolean()) (place / name).fail("must be true or false");
    return json[name].get<bool>();
}

Body read_body(const Json& json, const Place& place, const std::map<std::string, std::uint32_t>& meshes) {
    check_names(json, place, {"mesh", "fixed", "position", "rotation", "velocity", "spin", "poses"});
    if (!json.contains("mesh")) place.fail("has no mesh");
    const auto name = text(json["mesh"], place / "mesh");
    std::vector<std::string> names;
    names.reserve(meshes.size());
    for (const auto& [known, index] : meshes) names.push_back(known);
    const auto found = meshes.find(name);
    if (found == meshes.end()) (place / "mesh").fail(unknown("mesh", name, names));
    Body body{.mesh = found->second, .fixed = flag(json, "fixed", place), .deformable = false};
    if (body.fixed && (json.contains("velocity") || json.contains("spin") || json.contains("poses")))
        place.fail("is fixed and moves; leave one out");
    return body;
}

Json parse(const std::string& path) {
    std::ifstream file(path);
    if (!file || std::filesystem::is_directory(path))
        throw InputError(fmt::format("{}: cannot be read; name an existing scene description", path));
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    try {
        return Json::parse(text);
    } catch (const Json::parse_error& error) {
        const auto read = text.substr(0, error.byte == 0 ? 0 : error.byte - 1);
        const auto line = 1 + std::count(read.begin(), read.end(), '\n');
        throw InputError(fmt::format("{}:{}: not JSON; repair the description around this line", path, line));
    }
}

Frame frame_of(const std::vector<Motion>& motions, std::size_t index) {
    Frame frame;
    frame.deformed.resize(motions.size());
    for (const auto& motion : motions) frame.poses.push_back(motion.at(index));
    return frame;
}

} // namespace

Scene load_description(const std::string& path) {
    const auto json = parse(path);
    const Place root{path, {}};
    check_names(json, root, {"name", "units", "frames", "meshes", "bodies"});
    Scene scene;
    scene.name = json.contains("name") ? text(json["name"], root / "name")
                                       : std::filesystem::path(path).stem().string();
    if (json.contains("units")) scene.units = text(json["units"], root / "units");
    if (json.contains("frames")) {
        const auto frames = number(json["frames"], root / "frames");
        if (!(frames >= 1 && frames <= 1e7) || frames != std::floor(frames))
            (root / "frames").fail("must be an integer from 1 to 1e7");
        scene.frame_count = static_cast<std::size_t>(frames);
    }
    std::map<std::string, std::uint32_t> meshes;
    if (!json.contains("meshes") || !json["meshes"].is_object()) root.fail("has no meshes");
    for (const auto& [name, value] : json["meshes"].items()) {
        meshes[name] = static_cast<std::uint32_t>(scene.meshes.size());
        scene.meshes.push_back(
            read_one(value, root / "meshes" / name, std::filesystem::path(path).parent_path()));
    }
    if (!json.contains("bodies") || !json["bodies"].is_array() || json["bodies"].empty())
        root.fail("has no bodies");
    std::vector<Motion> motions;
    for (std::size_t i = 0; i < json["bodies"].size(); ++i) {
        scene.bodies.push_back(read_body(json["bodies"][i], root / "bodies" / i, meshes));
        motions.push_back(read_motion(json["bodies"][i], root / "bodies" / i, scene.frame_count));
    }
    scene.frame = [motions = std::move(motions)](std::size_t index) { return frame_of(motions, index); };
    scene.key = fmt::format("{}:frames={},bodies={:016x}", scene.name, scene.frame_count,
                            digest_of(json["bodies"].dump()));
    scene.digest = digest_of(scene);
    return scene;
}

Scene scene_from_meshes(std::span<const std::string> files, std::span<const Pose> poses) {
    if (poses.size() > files.size()) throw InputError("more poses than meshes; give one pose a mesh at most");
    Scene scene;
    scene.name = "meshes";
    std::vector<Motion> motions;
    for (std::size_t i = 0; i < files.size(); ++i) {
        scene.meshes.push_back(read_mesh(files[i]));
        scene.bodies.push_back({.mesh = static_cast<std::uint32_t>(i), .fixed = false, .deformable = false});
        motions.emplace_back();
        if (i < poses.size()) motions.back().start = poses[i];
        scene.key += (scene.key.empty() ? "meshes:" : ",") + scene.meshes.back().name;
    }
    scene.frame = [motions = std::move(motions)](std::size_t index) { return frame_of(motions, index); };
    scene.digest = digest_of(scene);
    return scene;
}

} // namespace tandem
