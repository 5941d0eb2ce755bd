// SPDX-License-Identifier: MIT
#include "algorithms/bodies/origin.h"

#include <cmath>

namespace tandem {

namespace {

using Box = Eigen::AlignedBox3d;

Box box_around(const std::vector<Eigen::Vector3d>& vertices) {
    Box box;
    for (const auto& v : vertices) box.extend(v);
    return box;
}

Box box_around(const Scene& scene, const Frame& frame) {
    std::vector<Box> meshes;
    for (const auto& mesh : scene.meshes) meshes.push_back(box_around(mesh.vertices));
    Box box;
    for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
        if (scene.bodies[body].deformable) {
            box.extend(box_around(frame.deformed[body]));
            continue;
        }
        const auto& own = meshes[scene.bodies[body].mesh];
        const auto& pose = frame.poses[body];
        for (int corner = 0; corner < 8 && !own.isEmpty(); ++corner)
            box.extend(pose.rotation.normalized() * own.corner(static_cast<Box::CornerType>(corner))
                       + pose.translation);
    }
    return box;
}

} // namespace

Eigen::Vector3d middle_of(const Scene& scene, const Frame& frame) {
    const auto box = box_around(scene, frame);
    const double longest = box.sizes().maxCoeff();
    if (!(longest > 0) || !box.min().allFinite() || !box.max().allFinite()) return Eigen::Vector3d::Zero();
    const double step = std::exp2(std::ceil(std::log2(longest)));
    return (box.center() / step).array().round() * step;
}

Eigen::Vector3d origin_of(const Scene& scene, Origin origin) {
    if (origin == Origin::world || !scene.frame || scene.frame_count == 0) return Eigen::Vector3d::Zero();
    return middle_of(scene, scene.frame(0));
}

Frame counted_from(const Eigen::Vector3d& origin, Frame frame) {
    for (std::size_t body = 0; body < frame.poses.size(); ++body) {
        if (frame.deformed[body].empty()) frame.poses[body].translation -= origin;
        for (auto& vertex : frame.deformed[body]) vertex -= origin;
    }
    return frame;
}

} // namespace tandem
