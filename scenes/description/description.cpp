// SPDX-License-Identifier: MIT
#include "scenes/builtin.h"
#include "scenes/description/describe_dynamics.h"
#include "scenes/description/series.h"
#include "base/digest.h"
#include "scenes/digest.h"
#include "base/error.h"
#include "base/memory.h"
#include "scenes/motion.h"
#include "scenes/parameters.h"
#include "base/read_json.h"
#include "scenes/shapes.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <map>

namespace tandem {

namespace {

using namespace description;

/// Normalises the quaternion, since descriptions are written by hand.
Eigen::Quaterniond quaternion(double w, double x, double y, double z, const JsonLocation& location) {
    const auto rotation = given_rotation(w, x, y, z);
    if (!rotation) location.fail("must not be the zero quaternion");
    return *rotation;
}

/// Motion of one body: a start with a velocity and a spin per frame, a list of poses, or vertices from files.
struct Motion {
    Pose start;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    double spin = 0;
    std::vector<Pose> poses;
    std::shared_ptr<const Series> series; ///< null: the body is rigid

    Pose at(std::size_t frame) const {
        if (!poses.empty()) return poses[frame];
        const auto time = static_cast<double>(frame);
        const double angle = spin * time;
        // A body that has not turned keeps the bits that it has with poses: each normalisation may change
        // some.
        return {angle == 0 ? start.rotation : unit(product(turn(axis, angle), start.rotation)),
                start.translation + time * velocity};
    }
};

/// How the files of a description are read. Their paths are relative to its folder, not to the working
/// directory.
struct Files {
    std::filesystem::path folder;
    MeshReading reading;
};

Mesh read_source(const Json& json, const JsonLocation& location, const Files& files) {
    if (json.contains("file"))
        return read_mesh((files.folder / text(json["file"], location / "file")).string(), files.reading);
    if (json.contains("box")) {
        const auto size = vector(json["box"], location / "box");
        if (!(size.minCoeff() > 0)) (location / "box").fail("must have sides above 0");
        return box(size);
    }
    const auto name = text(json["builtin"], location / "builtin");
    const auto names = built_in_names();
    if (std::find(names.begin(), names.end(), name) == names.end())
        (location / "builtin").fail(unknown("mesh", name, names));
    return built_in_mesh(name);
}

Mesh read_one(const Json& json, const JsonLocation& location, const Files& files) {
    check_names(json, location, {"builtin", "file", "box", "scale"});
    if (json.contains("builtin") + json.contains("file") + json.contains("box") != 1)
        location.fail("must name one builtin, file or box");
    const bool is_scaled = json.contains("scale");
    auto source = files;
    if (is_scaled) { // connected below, in the unit of the scene
        source.reading.weld.reset();
        source.reading.pressure.reset();
        source.reading.duplicates = Duplicates::keep;
    }
    auto mesh = read_source(json, location, source);
    if (is_scaled) {
        const double scale = positive(json["scale"], location / "scale");
        for (auto& v : mesh.vertices) v *= scale;
    }
    if (is_scaled || !json.contains("file")) complete_mesh(mesh, location.text(), files.reading);
    return mesh;
}

/// Velocity is in units a frame, spin is an axis and radians a frame. Angles are limited, since the sine of a
/// large angle has no accurate digits.
Motion read_motion(const Json& json, const JsonLocation& location, std::size_t frames) {
    Motion motion;
    if (json.contains("position")) motion.start.translation = vector(json["position"], location / "position");
    if (json.contains("rotation")) {
        const auto q = numbers<4>(json["rotation"], location / "rotation");
        motion.start.rotation = quaternion(q[0], q[1], q[2], q[3], location / "rotation");
    }
    if (json.contains("velocity")) motion.velocity = vector(json["velocity"], location / "velocity");
    if (json.contains("spin")) {
        const auto spin = numbers<4>(json["spin"], location / "spin");
        const double square = (spin[0] * spin[0] + spin[1] * spin[1]) + spin[2] * spin[2];
        if (!(square > 1e-300 && square < 1e300)) // otherwise the square has overflow or too few digits
            (location / "spin").fail("must have an axis of length 1e-150 to 1e150");
        const double length = std::sqrt(square);
        motion.axis = {spin[0] / length, spin[1] / length, spin[2] / length};
        motion.spin = spin[3];
        if (!(std::fabs(motion.spin) * static_cast<double>(frames) <= 1e6))
            (location / "spin").fail("must turn by no more than 1e6 radians in all frames together");
    }
    if (!json.contains("poses")) return motion;
    for (const auto* name : {"position", "rotation", "velocity", "spin"})
        if (json.contains(name)) (location / name).fail("is replaced by poses; leave one out");
    if (!json["poses"].is_array() || json["poses"].size() != frames)
        (location / "poses").fail(fmt::format("must be one pose a frame, {} in all", frames));
    for (std::size_t i = 0; i < frames; ++i) {
        const auto p = numbers<7>(json["poses"][i], location / "poses" / i);
        motion.poses.push_back(
            {quaternion(p[3], p[4], p[5], p[6], location / "poses" / i), {p[0], p[1], p[2]}});
    }
    return motion;
}

std::shared_ptr<const Series> read_series(const Json& json, const JsonLocation& location, const Mesh& mesh,
                                          std::size_t frames, const MeshReading& reading) {
    for (const auto* name : {"fixed", "position", "rotation", "velocity", "spin", "poses"})
        if (json.contains(name)) (location / name).fail("is replaced by series; leave one out");
    const auto& files = json["series"];
    const auto place = location / "series";
    if (!files.is_array() || files.size() != frames)
        place.fail(fmt::format("must be one mesh file a frame, {} in all", frames));
    std::vector<std::string> paths;
    for (std::size_t i = 0; i < frames; ++i)
        paths.push_back(
            (std::filesystem::path(location.file).parent_path() / text(files[i], place / i)).string());
    return std::make_shared<const Series>(std::move(paths), mesh, reading);
}

/// The bits of a list of groups.
std::uint32_t read_groups(const Json& json, const JsonLocation& location) {
    if (!json.is_array()) location.fail("must be an array of groups");
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < json.size(); ++i)
        bits |= std::uint32_t{1} << static_cast<std::uint32_t>(whole(json[i], location / i, 0, 31));
    return bits;
}

Body read_body(const Json& json, const JsonLocation& location,
               const std::map<std::string, std::uint32_t>& meshes) {
    check_names(json, location,
                {"mesh", "fixed", "position", "rotation", "velocity", "spin", "poses", "series", "material",
                 "elastic", "groups", "meets"});
    if (!json.contains("mesh")) location.fail("has no mesh");
    const auto name = text(json["mesh"], location / "mesh");
    std::vector<std::string> names;
    names.reserve(meshes.size());
    for (const auto& [known, index] : meshes) names.push_back(known);
    const auto found = meshes.find(name);
    if (found == meshes.end()) (location / "mesh").fail(unknown("mesh", name, names));
    Body body{
        .mesh = found->second, .fixed = flag(json, "fixed", location), .deformable = json.contains("series")};
    if (body.fixed && (json.contains("velocity") || json.contains("spin") || json.contains("poses")))
        location.fail("is fixed and moves; leave one out");
    if (json.contains("groups")) body.groups = read_groups(json["groups"], location / "groups");
    if (json.contains("meets")) body.meets = read_groups(json["meets"], location / "meets");
    return body;
}

/// Pairs of bodies in either order, or of a body with itself.
void read_never_meet(const Json& json, const JsonLocation& location, Scene& scene) {
    if (!json.is_array()) location.fail("must be an array of pairs of bodies");
    const auto last = static_cast<double>(scene.bodies.size() - 1);
    for (std::size_t i = 0; i < json.size(); ++i) {
        if (!json[i].is_array() || json[i].size() != 2) (location / i).fail("must be a pair of bodies");
        const auto a = static_cast<std::uint32_t>(whole(json[i][0], location / i / 0, 0, last));
        const auto b = static_cast<std::uint32_t>(whole(json[i][1], location / i / 1, 0, last));
        scene.never_meet.push_back({std::min(a, b), std::max(a, b)});
    }
    std::ranges::sort(scene.never_meet);
    // No std::ranges::unique: clang 14 does not compile the one of g++ 12.
    scene.never_meet.erase(std::unique(scene.never_meet.begin(), scene.never_meet.end()),
                           scene.never_meet.end());
}

/// Computed on demand, since a scripted scene keeps no frames in memory.
Frame frame_of(const std::vector<Motion>& motions, std::size_t index) {
    Frame frame;
    frame.deformed.resize(motions.size());
    for (std::size_t body = 0; body < motions.size(); ++body) {
        frame.poses.push_back(motions[body].at(index));
        if (motions[body].series) frame.deformed[body] = motions[body].series->vertices(index);
    }
    return frame;
}

/// Reads meshes and bodies into the scene and returns the motions of the bodies.
std::vector<Motion> read_bodies(const Json& json, const JsonLocation& root, Scene& scene) {
    std::map<std::string, std::uint32_t> meshes;
    if (!json.contains("meshes") || !json["meshes"].is_object()) root.fail("has no meshes");
    const Files files{std::filesystem::path(root.file).parent_path(), scene.reading};
    for (const auto& [name, value] : json["meshes"].items()) {
        meshes[name] = static_cast<std::uint32_t>(scene.meshes.size());
        scene.meshes.push_back(read_one(value, root / "meshes" / name, files));
    }
    if (!json.contains("bodies") || !json["bodies"].is_array() || json["bodies"].empty())
        root.fail("has no bodies");
    std::vector<Motion> motions;
    for (std::size_t i = 0; i < json["bodies"].size(); ++i) {
        scene.bodies.push_back(read_body(json["bodies"][i], root / "bodies" / i, meshes));
        const auto& body = json["bodies"][i];
        motions.push_back(read_motion(body, root / "bodies" / i, scene.frame_count));
        if (body.contains("series"))
            motions.back().series =
                read_series(body, root / "bodies" / i, scene.meshes[scene.bodies.back().mesh],
                            scene.frame_count, scene.reading);
    }
    return motions;
}

} // namespace

Scene load_description(const std::string& path, const MeshReading& reading) {
    const auto json = read_json(path, "scene description or plan");
    if (json.is_object() && json.contains("plan"))
        throw InputError(fmt::format("{}: is a plan, not a scene; give it to 'tandem run'", path));
    const JsonLocation root{path, {}};
    check_names(json, root, {"name", "units", "frames", "meshes", "bodies", "never_meet", "dynamics"});
    Scene scene;
    scene.reading = reading;
    scene.name = json.contains("name") ? text(json["name"], root / "name")
                                       : std::filesystem::path(path).stem().string();
    if (json.contains("units")) scene.units = text(json["units"], root / "units");
    if (json.contains("frames"))
        scene.frame_count = static_cast<std::size_t>(whole(json["frames"], root / "frames", 1, 1e7));
    const auto motions = read_bodies(json, root, scene);
    if (json.contains("never_meet")) read_never_meet(json["never_meet"], root / "never_meet", scene);
    refuse_beyond_memory(fmt::format("{}: the vertices of all bodies", path),
                         3 * sizeof(float) * static_cast<double>(vertex_count(scene)));
    scene.key = fmt::format("{}:frames={},bodies={:016x}", scene.name, scene.frame_count,
                            digest_of(json["bodies"].dump()));
    if (json.contains("dynamics")) {
        for (std::size_t i = 0; i < motions.size(); ++i)
            if (motions[i].series)
                (root / "bodies" / i / "series").fail("has no place beside dynamics; leave one out");
        Frame start = frame_of(motions, 0);
        scene.dynamics = read_dynamics(json, root, scene, start);
        scene.frame = [start = std::move(start)](std::size_t) { return start; };
        scene.key += fmt::format(",dynamics={:016x}", digest_of(json["dynamics"].dump()));
    } else {
        refuse_dynamics(json, root);
        for (const auto& motion : motions)
            if (motion.series) scene.key += fmt::format(",series={:016x}", motion.series->digest());
        scene.frame = [motions](std::size_t index) { return frame_of(motions, index); };
    }
    scene.digest = digest_of(scene);
    return scene;
}

Scene scene_from_meshes(std::span<const std::string> files, std::span<const Pose> poses,
                        const MeshReading& reading) {
    if (poses.size() > files.size()) throw InputError("more poses than meshes; give one pose a mesh at most");
    Scene scene;
    scene.name = "meshes";
    scene.reading = reading;
    std::vector<Motion> motions;
    for (std::size_t i = 0; i < files.size(); ++i) {
        scene.meshes.push_back(read_mesh(files[i], reading));
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
