// SPDX-License-Identifier: MIT
#include "algorithms/bodies/shift.h"

#include "algorithms/bodies/moved_coordinate.h"
#include "algorithms/bodies/pack.h"

#include <algorithm>
#include <cmath>

namespace tandem {

namespace {

/// Middles further away than this many extents are shifts.
constexpr double near_extents = 8;

} // namespace

/// Vertices without a tetrahedron do not count: some files have one at the origin.
Eigen::Vector3d shift_of(const Mesh& mesh) {
    Eigen::AlignedBox3d box;
    for (const auto& tetrahedron : mesh.tetrahedra)
        for (const auto vertex : tetrahedron) box.extend(mesh.vertices[vertex]);
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    if (box.isEmpty()) return shift;
    for (int axis = 0; axis < 3; ++axis) {
        const double extent = box.max()[axis] - box.min()[axis];
        const double middle = box.min()[axis] + 0.5 * extent;
        if (std::fabs(middle) > near_extents * extent) shift[axis] = middle;
    }
    return shift;
}

bool has_far_mesh(const Scene& scene) {
    return std::ranges::any_of(scene.meshes, [](const auto& mesh) { return !shift_of(mesh).isZero(0); });
}

std::shared_ptr<const Scene> centred(const Scene& scene, Origin origin) {
    if (origin == Origin::world || !has_far_mesh(scene)) return nullptr;
    std::vector<Eigen::Vector3d> shifts;
    for (const auto& mesh : scene.meshes) shifts.push_back(shift_of(mesh));
    auto result = std::make_shared<Scene>(scene);
    for (std::size_t mesh = 0; mesh < shifts.size(); ++mesh)
        for (auto& vertex : result->meshes[mesh].vertices) vertex -= shifts[mesh];
    result->shifts = std::move(shifts);
    if (scene.frame)
        result->frame = [&scene, moved = result.get()](std::size_t i) {
            return shifted(*moved, scene.frame(i));
        };
    return result;
}

/// The shift is a vertex like others, which the pose moves in double.
Pose shifted(const Pose& pose, const Eigen::Vector3d& shift) {
    if (shift.isZero(0)) return pose;
    const auto rows = pose_rows(pose);
    const std::array<double, 3> c{shift.x(), shift.y(), shift.z()};
    auto result = pose;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::array<double, 4> row{rows[4 * i], rows[4 * i + 1], rows[4 * i + 2], rows[4 * i + 3]};
        result.translation[static_cast<int>(i)] = moved_coordinate(row, c);
    }
    return result;
}

Frame shifted(const Scene& centred, Frame frame) {
    for (std::size_t body = 0; body < centred.bodies.size(); ++body)
        if (!centred.bodies[body].deformable)
            frame.poses[body] = shifted(frame.poses[body], shift_in(centred, centred.bodies[body].mesh));
    return frame;
}

Eigen::Vector3d shift_in(const Scene& scene, std::size_t mesh) {
    return scene.shifts.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : scene.shifts[mesh];
}

} // namespace tandem
