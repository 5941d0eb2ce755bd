// SPDX-License-Identifier: MIT
#include "scenes/description/describe_dynamics.h"

#include "scenes/description/describe_settings.h"
#include "base/error.h"
#include "scenes/motion.h"
#include "scenes/overlap.h"

#include <algorithm>
#include <cmath>

namespace tandem::description {

namespace {

Materials read_materials(const Json& json, const JsonLocation& location) {
    Materials materials;
    auto& [names, densities, surfaces] = materials;
    if (!json.contains("materials") || !json["materials"].is_object() || json["materials"].empty())
        location.fail("has no materials");
    for (const auto& [name, density] : json["materials"].items()) {
        names.push_back(name);
        densities.push_back(positive(density, location / "materials" / name));
    }
    if (!json.contains("surfaces")) return materials;
    if (!json["surfaces"].is_array()) (location / "surfaces").fail("must be an array");
    for (std::size_t i = 0; i < json["surfaces"].size(); ++i) {
        const auto& entry = json["surfaces"][i];
        const auto at = location / "surfaces" / i;
        check_names(entry, at, {"a", "b", "friction", "restitution"});
        for (const auto* name : {"a", "b", "friction", "restitution"})
            if (!entry.contains(name)) at.fail(fmt::format("has no {}", name));
        const auto a = static_cast<std::uint32_t>(choice(entry["a"], at / "a", "material", names));
        const auto b = static_cast<std::uint32_t>(choice(entry["b"], at / "b", "material", names));
        const Surface surface{number(entry["friction"], at / "friction", 0, largest),
                              number(entry["restitution"], at / "restitution", 0, 1)};
        if (!surfaces.emplace(MaterialPair(a, b), surface).second)
            at.fail("names a pair of materials that has a surface already");
    }
    return materials;
}

Elastic read_elastic(const Json& json, const JsonLocation& location, const Mesh& mesh) {
    check_names(json, location, {"law", "young", "poisson", "damping", "pinned"});
    for (const auto* name : {"young", "poisson"})
        if (!json.contains(name)) location.fail(fmt::format("has no {}", name));
    Elastic elastic;
    if (json.contains("law"))
        elastic.law = static_cast<Elastic::Law>(
            choice(json["law"], location / "law", "law", {"corotational", "saint_venant_kirchhoff"}));
    elastic.young = positive(json["young"], location / "young");
    elastic.poisson = number(json["poisson"], location / "poisson", 0, 0.499);
    if (json.contains("damping")) elastic.damping = number(json["damping"], location / "damping", 0, largest);
    if (!json.contains("pinned")) return elastic;
    if (!json["pinned"].is_array()) (location / "pinned").fail("must be an array of vertices");
    const auto last = static_cast<double>(mesh.vertices.size() - 1);
    for (std::size_t i = 0; i < json["pinned"].size(); ++i)
        elastic.pinned.push_back(
            static_cast<std::uint32_t>(whole(json["pinned"][i], location / "pinned" / i, 0, last)));
    return elastic;
}

/// Moves a body's start into world vertices and resets its pose to the identity.
void deform(const Mesh& mesh, Pose& pose, std::vector<Eigen::Vector3d>& vertices) {
    for (const auto& v : mesh.vertices) vertices.push_back(rotated(pose.rotation, v) + pose.translation);
    pose = {};
}

/// The material is optional in a scene with one material.
BodyDynamics read_body(const Json& json, const JsonLocation& location, const Materials& materials) {
    BodyDynamics body;
    if (json.contains("poses"))
        (location / "poses").fail("cannot be used in a scene with dynamics; leave it out");
    if (json.contains("material"))
        body.material = static_cast<std::uint32_t>(
            choice(json["material"], location / "material", "material", materials.names));
    else if (materials.names.size() > 1)
        location.fail("has no material");
    if (json.contains("velocity")) body.velocity = vector(json["velocity"], location / "velocity");
    if (!json.contains("spin")) return body;
    const auto spin = numbers<4>(json["spin"], location / "spin");
    const Eigen::Vector3d axis(spin[0], spin[1], spin[2]);
    body.spin = axis * (spin[3] / std::sqrt((spin[0] * spin[0] + spin[1] * spin[1]) + spin[2] * spin[2]));
    return body;
}

/// Any two materials whose bodies can touch need a surface.
void check_surfaces(const Materials& materials, const Scene& scene, const std::vector<BodyDynamics>& bodies,
                    const JsonLocation& location) {
    if (const auto missing = missing_surface(materials, scene.bodies, bodies))
        (location / "surfaces")
            .fail(fmt::format("has no entry for {} and {}", materials.names[missing->first],
                              materials.names[missing->second]));
}

/// Reads materials and elasticity of all bodies.
void read_bodies(const Json& json, const JsonLocation& location, Scene& scene, Frame& start,
                 Dynamics& dynamics) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const auto& entry = json[i];
        dynamics.bodies.push_back(read_body(entry, location / i, dynamics.materials));
        if (!entry.contains("elastic")) continue;
        if (scene.bodies[i].fixed)
            (location / i / "elastic").fail("cannot be used for a fixed body; leave one out");
        if (entry.contains("spin")) (location / i / "spin").fail("cannot be given to an elastic body");
        const auto& mesh = scene.meshes[scene.bodies[i].mesh];
        dynamics.bodies.back().elastic = static_cast<std::int32_t>(dynamics.elastics.size());
        dynamics.elastics.push_back(read_elastic(entry["elastic"], location / i / "elastic", mesh));
        scene.bodies[i].deformable = true;
        deform(mesh, start.poses[i], start.deformed[i]);
    }
}

} // namespace

std::shared_ptr<const Dynamics> read_dynamics(const Json& json, const JsonLocation& root, Scene& scene,
                                              Frame& start) {
    const auto& entry = json["dynamics"];
    const auto location = root / "dynamics";
    check_names(entry, location,
                {"gravity", "step", "steps", "materials", "surfaces", "solver", "stepping", "reduction"});
    if (scene.frame_count != 1)
        (root / "frames").fail("must be 1 or left out in a scene with dynamics; give steps in /dynamics");
    auto dynamics = std::make_shared<Dynamics>();
    dynamics->materials = read_materials(entry, location);
    read_settings(entry, location, *dynamics);
    read_bodies(json["bodies"], root / "bodies", scene, start, *dynamics);
    check_surfaces(dynamics->materials, scene, dynamics->bodies, location);
    if (const auto found = first_overlap(scene, start, true))
        (root / "bodies" / (*found)[1])
            .fail(fmt::format("overlaps body {}, and both are fixed; move one", (*found)[0]));
    return dynamics;
}

void refuse_dynamics(const Json& json, const JsonLocation& root) {
    for (std::size_t i = 0; i < json["bodies"].size(); ++i)
        for (const auto* name : {"material", "elastic"})
            if (json["bodies"][i].contains(name))
                (root / "bodies" / i / name).fail("needs a scene with dynamics");
}

} // namespace tandem::description
