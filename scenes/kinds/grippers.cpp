// SPDX-License-Identifier: MIT
#include "scenes/body_memory.h"
#include "scenes/cubes.h"
#include "scenes/motion.h"
#include "scenes/parameters.h"
#include "scenes/pressure_field.h"
#include "base/random.h"
#include "scenes/refine.h"

namespace tandem {

namespace {

constexpr double pad_modulus = 1e5, object_modulus = 1e6; ///< Pa
const Eigen::Vector3d pad_size{0.02, 0.06, 0.04};         ///< m; a finger moves along x
const Eigen::Vector3d object_radii{0.03, 0.025, 0.035};   ///< m
constexpr double open_at = 0.036, closed_at = 0.024;      ///< m, a finger's inner side from the middle
constexpr std::size_t closing = 10;                       ///< frames from open to closed
constexpr double most_shift = 0.003;                      ///< m, of an object along each axis
constexpr double most_turn = 0.4;                         ///< radians, of an object
constexpr std::uint64_t bodies_of_world = 3;              ///< finger, finger, object

Mesh compliant(Mesh mesh, double modulus, std::uint64_t levels) {
    mesh = refined(mesh, levels);
    make_pressures(mesh, modulus);
    return mesh;
}

/// Where each world's object is.
std::vector<Pose> object_poses(std::uint64_t worlds, std::uint64_t seed) {
    Random random(seed);
    std::vector<Pose> poses(worlds);
    for (auto& pose : poses) {
        for (auto& x : pose.translation) x = random.uniform(-most_shift, most_shift);
        const auto axis = random.direction();
        pose.rotation = turn(axis, random.uniform(0, most_turn));
    }
    return poses;
}

/// The fingers close for `closing` frames and open for as many. The right one is turned by half a turn.
Frame gripped(const std::vector<Pose>& objects, std::size_t step) {
    const auto phase = step % (2 * closing);
    const auto part = static_cast<double>(phase < closing ? phase : 2 * closing - phase) / closing;
    const double side = open_at + (closed_at - open_at) * part + 0.5 * pad_size.x();
    const Pose left{.translation = {-side, 0, 0}};
    const Pose right{.rotation = Eigen::Quaterniond(0, 0, 1, 0), .translation = {side, 0, 0}};
    Frame frame;
    frame.poses.reserve(bodies_of_world * objects.size());
    for (const auto& object : objects) frame.poses.insert(frame.poses.end(), {left, right, object});
    frame.deformed.resize(frame.poses.size());
    return frame;
}

Scene make_grippers(std::span<const SceneParameter> parameters) {
    Scene scene;
    const auto worlds = integer_parameter(parameters, "worlds", 1, 1000000);
    const auto seed = integer_parameter(parameters, "seed", 0, ~std::uint64_t{0});
    scene.frame_count = integer_parameter(parameters, "frames", 1, 1000000);
    const auto levels = refine_value(parameters);
    const auto pad = box_of_cubes("finger", pad_size, {2, 8, 4});
    const auto object = ball_of_cubes("object", object_radii, 6);
    refuse_bodies_beyond_memory(bodies_of_world * worlds, object, levels);
    scene.meshes = {compliant(pad, pad_modulus, levels), compliant(object, object_modulus, levels)};
    for (std::uint64_t world = 0; world < worlds; ++world)
        for (const std::uint32_t mesh : {0, 0, 1}) scene.bodies.push_back({.mesh = mesh});
    if (worlds > 1) scene.world_size = bodies_of_world;
    scene.frame = [objects = object_poses(worlds, seed)](std::size_t step) { return gripped(objects, step); };
    return scene;
}

} // namespace

SceneKind grippers_kind() {
    return {"grippers",
            "worlds of two compliant fingers that close on an object, with pressure fields of their own; the "
            "object keeps its place, no forces",
            {{"worlds", "16", "worlds of three bodies at one place, whose bodies never meet"},
             {"seed", "1", "seed of the objects' poses"},
             {"frames", "11", "time steps; the fingers close for 10 and open for 10"},
             refine_parameter()},
            make_grippers};
}

} // namespace tandem
