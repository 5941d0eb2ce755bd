// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/dynamics.h"
#include "scenes/mesh.h"

#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

namespace tandem {

/// x_world = rotation * x_mesh + translation; the rotation is a unit quaternion.
struct Pose {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity(); ///< from mesh to world axes; of length 1
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();        ///< world position of the mesh's origin
};

/// An instance of a mesh. A fixed body has the same pose in every frame. A deformable body has its own world
/// vertices in every frame, and its pose is the identity.
struct Body {
    std::uint32_t mesh = 0;            ///< index into Scene::meshes
    bool fixed = false;                ///< has the same pose in every frame
    bool deformable = false;           ///< has its own vertices in Frame::deformed
    std::uint32_t groups = 1;          ///< bit i: it is in group i
    std::uint32_t meets = 0xffff'ffff; ///< bit i: it meets bodies of group i
};

/// The state of all bodies at one time step.
struct Frame {
    std::vector<Pose> poses;                            ///< one per body
    std::vector<std::vector<Eigen::Vector3d>> deformed; ///< one per body; empty for rigid bodies
    /// Masked tetrahedra, which are in no pair and in no bound. One ascending list a body; no lists when none
    /// is masked.
    std::vector<std::vector<std::uint32_t>> skipped{};
};

/// Meshes, bodies and their motion. Immutable once made. A scene with dynamics has one frame, its start.
struct Scene {
    std::string name;         ///< "plates"
    std::string key;          ///< name and every parameter: "pile:bodies=64,density=0.2,..."
    std::string units = "m";  ///< unit of length, for records and exports; it changes no value
    std::vector<Mesh> meshes; ///< bodies may share them
    std::vector<Body> bodies; ///< in the order of Frame::poses
    /// Pairs of bodies a < b that never meet, and of a body a = b that never meets itself; ascending.
    std::vector<std::array<std::uint32_t, 2>> never_meet{};
    /// Bodies of each world, which follow each other by their numbers: bodies of two worlds never meet. 0:
    /// all bodies are of one world.
    std::uint32_t world_size = 0;
    std::size_t frame_count = 1;              ///< number of frames
    std::function<Frame(std::size_t)> frame;  ///< frame(i) for i < frame_count; pure
    std::shared_ptr<const Dynamics> dynamics; ///< null: the motion is scripted, all frames are defined
    std::function<double(std::size_t)> time;  ///< time of frame i in s; null: frames have no times
    /// The step of the simulation that frame i is of; null: no simulation was recorded.
    std::function<std::uint64_t(std::size_t)> step{};
    std::string end;          ///< message for frames after the last of a recording; empty in other scenes
    std::uint64_t digest = 0; ///< digest of meshes, bodies and motion; equal on every machine
    MeshReading reading{};    ///< how its meshes were read and connected
    /// In a subscene, the number of each body in the whole scene, ascending. Empty in a whole scene.
    std::vector<std::uint32_t> numbers{};
    /// In a centred scene (algorithms/bodies/shift.h), what was subtracted from the vertices of each mesh.
    /// Empty in other scenes.
    std::vector<Eigen::Vector3d> shifts{};
};

/// The deformable bodies, ascending.
std::vector<std::uint32_t> deformable_bodies(const Scene& scene);

/// The number of a body in the whole scene, which results use.
inline std::uint32_t number_of(const Scene& scene, std::size_t body) {
    return scene.numbers.empty() ? static_cast<std::uint32_t>(body) : scene.numbers[body];
}

/// The world of a body; 0 in a scene of one world.
inline std::uint32_t world_of(const Scene& scene, std::size_t body) {
    return scene.world_size == 0 ? 0 : number_of(scene, body) / scene.world_size;
}

/// Whether the broad phase may pair two bodies, or a body with itself: not if both are fixed, nor of two
/// worlds, nor for a pair of `never_meet`. Two bodies must each meet a group of the other.
bool may_meet(const Scene& scene, std::uint32_t a, std::uint32_t b);

/// Whether worlds, groups or `never_meet` keep any two bodies apart.
bool has_filters(const Scene& scene);

/// The tetrahedra of a body that take no part in a frame: those that it skips, and merged duplicates;
/// ascending.
std::vector<std::uint32_t> skipped_in(const Scene& scene, const Frame& frame, std::size_t body);

/// A named parameter of a scene with its value; in a SceneKind, its default.
struct SceneParameter {
    std::string name, ///< in a scene's specification
        value,        ///< number or word, as text
        help;         ///< one line for listings
    /// The value that keys leave out, so that they equal those of records without this parameter; empty:
    /// none.
    std::string left_out{};
};

/// A kind of scene that the project generates.
struct SceneKind {
    std::string name;                       ///< "plates", in a scene's specification
    std::string models;                     ///< what the scene models and what it leaves out, one line
    std::vector<SceneParameter> parameters; ///< all of the kind, with their defaults
    std::function<Scene(std::span<const SceneParameter>)> make; ///< all parameters, with their values
};

std::span<const SceneKind> scene_kinds();

/// "NAME", "NAME:par=value,par=value", or the path of a scene description (.json) or of a recording
/// (.frames). `reading` applies to mesh files, and its duplicates, welding and pressure to all
/// meshes. Throws InputError.
Scene make_scene(std::string_view specification, const MeshReading& reading = {});

/// A scene with one body per mesh file. poses[i] belongs to files[i]; missing poses are the identity.
Scene scene_from_meshes(std::span<const std::string> files, std::span<const Pose> poses,
                        const MeshReading& reading = {});

std::size_t vertex_count(const Scene& scene);
std::size_t tetrahedron_count(const Scene& scene);

} // namespace tandem
