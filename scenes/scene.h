// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/dynamics.h"
#include "scenes/mesh.h"

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

namespace tandem {

/// x_world = rotation * x_mesh + translation; the rotation is a unit quaternion.
struct Pose {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

/// An instance of a mesh. A fixed body has the same pose in every frame; a deformable body has world vertices
/// of its own in every frame, and its pose is the identity.
struct Body {
    std::uint32_t mesh = 0;
    bool fixed = false;
    bool deformable = false;
};

/// The state of all bodies at one time step.
struct Frame {
    std::vector<Pose> poses;                            ///< one per body
    std::vector<std::vector<Eigen::Vector3d>> deformed; ///< one per body; empty for rigid bodies
    /// Tetrahedra that take no part: they are in no pair and in no bound. One ascending list a body; no lists
    /// where all take part.
    std::vector<std::vector<std::uint32_t>> skipped{};
};

/// Meshes, bodies and their motion. Immutable once made. A scene with dynamics has one frame, its start.
struct Scene {
    std::string name; ///< "plates"
    std::string key;  ///< name and every parameter: "pile:bodies=64,density=0.2,..."
    std::string units = "m";
    std::vector<Mesh> meshes;
    std::vector<Body> bodies;
    std::size_t frame_count = 1;
    std::function<Frame(std::size_t)> frame;  ///< frame(i) for i < frame_count; pure
    std::shared_ptr<const Dynamics> dynamics; ///< null: the motion is scripted, frames are known beforehand
    std::function<double(std::size_t)> time;  ///< s at frame i; null: frames have no times
    std::string end;          ///< why there are no more frames, one line; empty: there never were
    std::uint64_t digest = 0; ///< of meshes, bodies and motion; equal on every machine
    /// Of a part of another scene: by body, ascending, the number that answers give it. None of a whole one.
    std::vector<std::uint32_t> numbers{};
};

/// The number that answers give a body.
inline std::uint32_t number_of(const Scene& scene, std::size_t body) {
    return scene.numbers.empty() ? static_cast<std::uint32_t>(body) : scene.numbers[body];
}

/// A named parameter of a scene with its default, for listings.
struct SceneParameter {
    std::string name, value, help;
};

/// A scene the project makes itself.
struct SceneKind {
    std::string name;
    std::string models; ///< what it models and what it leaves out, one line
    std::vector<SceneParameter> parameters;
    std::function<Scene(std::span<const SceneParameter>)> make; ///< all parameters, with their values
};

std::span<const SceneKind> scene_kinds();

/// "NAME", "NAME:par=value,par=value", or the path of a scene description (.json) or of a recording
/// (.frames). Throws InputError.
Scene make_scene(std::string_view specification);

/// One body per mesh file; poses[i] belongs to files[i], missing ones are the identity.
Scene scene_from_meshes(std::span<const std::string> files, std::span<const Pose> poses);

std::size_t vertex_count(const Scene& scene);
std::size_t tetrahedron_count(const Scene& scene);

} // namespace tandem
