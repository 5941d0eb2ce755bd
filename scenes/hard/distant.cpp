// SPDX-License-Identifier: MIT
// Group i: bodies whose distance from the origin takes more digits than float has.
#include "scenes/hard/families.h"
#include "scenes/hard/maker.h"
#include "scenes/hard/solids.h"

#include <cmath>

namespace tandem::hard {

namespace {

using Vector = Eigen::Vector3d;

/// Two bodies at one place in the world. All couples are at the same place, and each is a group of bodies.
constexpr std::uint32_t couples = 3;
constexpr std::uint64_t meeting_of_a_couple = 833; ///< counted by the oracle

/// A multiple of `unit`. The sum of a vertex and a distance of up to 2^31 is then exact in double.
Vector on_lattice(const Vector& v, double unit) { return (v / unit).array().round() * unit; }

/// A box of size 1 with shaken vertices: multiples of 2^-18, so that sums near the origin are exact in float.
Mesh shaken(Random& random, const Vector& at) {
    auto mesh = grid({3, 3, 3}, {1, 1, 1});
    for (auto& v : mesh.vertices) {
        const double by = 0.1 * random.uniform();
        v = on_lattice(v + at + by * random.direction(), 0x1p-18);
    }
    return mesh;
}

/// A rotation by 120 degrees, whose matrix is exact, and its inverse.
Vector turned(const Vector& v) { return {v.z(), v.x(), v.y()}; }
Vector turned_back(const Vector& v) { return {v.y(), v.z(), v.x()}; }

void add_couple(Scene& scene, std::vector<Pose>& poses, const std::array<Mesh, 2>& bodies, const Pose& pose,
                Vector (*place)(const Vector&), const Vector& shift) {
    const auto group = 1u << scene.bodies.size() / 2;
    for (const auto& body : bodies) {
        scene.bodies.push_back(
            {.mesh = static_cast<std::uint32_t>(scene.meshes.size()), .groups = group, .meets = group});
        scene.meshes.push_back(body);
        for (auto& v : scene.meshes.back().vertices) v = place(v) + shift;
        poses.push_back(pose);
    }
}

/// The couples are moved from the origin by the mesh, by the pose, and by both, with a rotation. The bodies
/// do not depend on the seed, so that the number of pairs that meet does not either.
Scene distant(Random& random, double distance) {
    Random shape(1);
    const std::array bodies{shaken(shape, {0, 0, 0}), shaken(shape, {0.4, -0.3, 0.2})};
    const Vector world = on_lattice(distance * random.direction(), 0x1p-10),
                 own = on_lattice(distance * random.direction(), 0x1p-10);
    const auto same = [](const Vector& v) { return v; };
    Scene scene;
    std::vector<Pose> poses;
    add_couple(scene, poses, bodies, {}, same, world);
    add_couple(scene, poses, bodies, {Eigen::Quaterniond::Identity(), world}, same, {0, 0, 0});
    add_couple(scene, poses, bodies, {Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), world - turned(own)},
               turned_back, own);
    scene.frame = [poses](std::size_t) {
        return Frame{poses, std::vector<std::vector<Vector>>(poses.size())};
    };
    return scene;
}

std::uint64_t distant_meeting(double) { return couples * meeting_of_a_couple; }

constexpr HardFamily distant_table[] = {
    {.row = 59,
     .group = 'i',
     .name = "far",
     .summary = "equal bodies, moved far from the origin in the mesh, in the pose and in both",
     .knob = {"distance in sizes of a body", 1, 1e9, 1e6},
     .truth = HardTruth::oracle,
     .metric = "MISS",
     .fails = "vertices rounded before they are moved",
     .scene = distant,
     .meeting = distant_meeting,
     .distant = true}};

} // namespace

std::span<const HardFamily> distant_families() { return distant_table; }

} // namespace tandem::hard
