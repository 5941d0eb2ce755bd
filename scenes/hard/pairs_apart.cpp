// SPDX-License-Identifier: MIT
#include "scenes/hard/pairs_apart.h"

#include "scenes/hard/solids.h"

#include <numeric>

namespace tandem::hard {

namespace {

using Vertices = std::vector<Eigen::Vector3d>;

/// A permutation of the axes with random signs, which is exact.
class Turned {
public:
    explicit Turned(Random& random) {
        std::iota(axes_.begin(), axes_.end(), 0);
        for (unsigned i = 2; i > 0; --i) std::swap(axes_[i], axes_[random.next() % (i + 1)]);
        for (auto& sign : signs_) sign = random.next() % 2 == 0 ? 1 : -1;
    }
    Eigen::Vector3d operator()(const Eigen::Vector3d& v) const {
        return {signs_[0] * v[axes_[0]], signs_[1] * v[axes_[1]], signs_[2] * v[axes_[2]]};
    }

private:
    std::array<int, 3> axes_{};
    std::array<double, 3> signs_{};
};

Mesh one_tetrahedron(const Corners& corners) {
    FloatCorners narrow;
    for (unsigned i = 0; i < 4; ++i)
        for (int axis = 0; axis < 3; ++axis) narrow[i][static_cast<unsigned>(axis)] = exact(corners[i][axis]);
    return separate("moving", {narrow});
}

/// Bodies 2 i and 2 i + 1 are group i, which meets itself only.
Scene scene_of_pairs(std::vector<Mesh> meshes, bool deformable, const std::array<Frame, 2>& frames) {
    Scene scene;
    scene.meshes = std::move(meshes);
    for (std::uint32_t body = 0; body < scene.meshes.size(); ++body)
        scene.bodies.push_back(
            {.mesh = body, .deformable = deformable, .groups = 1u << body / 2, .meets = 1u << body / 2});
    scene.frame_count = frames.size();
    scene.frame = [frames](std::size_t index) { return frames[index]; };
    return scene;
}

} // namespace

std::uint64_t half_of_pairs_apart(double) { return pairs_apart / 2; }

Scene moving_pairs(Random& random, const std::vector<std::array<MovingCorners, 2>>& pairs) {
    std::vector<Mesh> meshes;
    std::array<Frame, 2> frames;
    for (const auto& pair : pairs) {
        const Turned turned(random);
        for (const auto& corners : pair) {
            std::array<unsigned, 4> order{0, 1, 2, 3};
            for (unsigned i = 3; i > 0; --i) std::swap(order[i], order[random.next() % (i + 1)]);
            for (unsigned end = 0; end < 2; ++end) {
                Corners placed;
                for (unsigned i = 0; i < 4; ++i) placed[i] = turned(corners[end][order[i]]);
                auto mesh = one_tetrahedron(placed);
                frames[end].deformed.push_back(mesh.vertices);
                if (end == 0) meshes.push_back(std::move(mesh));
            }
        }
    }
    for (auto& frame : frames) frame.poses.resize(meshes.size());
    return scene_of_pairs(std::move(meshes), true, frames);
}

Scene turning_pairs(Random& random, const std::vector<TurningCorners>& pairs) {
    std::vector<Mesh> meshes;
    std::array<Frame, 2> frames;
    for (const auto& pair : pairs) {
        meshes.push_back(one_tetrahedron(pair.a));
        meshes.push_back(one_tetrahedron(pair.b));
        for (unsigned end = 0; end < 2; ++end) {
            Eigen::Vector3d by;
            for (auto& x : by) x = whole(random, -16, 16);
            for (auto pose : end == 0 ? pair.from : pair.to) {
                pose.translation += by;
                frames[end].poses.push_back(pose);
            }
        }
    }
    for (auto& frame : frames) frame.deformed.assign(meshes.size(), Vertices());
    return scene_of_pairs(std::move(meshes), false, frames);
}

} // namespace tandem::hard
