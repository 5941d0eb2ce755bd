// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/digest.h"
#include "base/error.h"
#include "base/random.h"
#include "scenes/scene.h"
#include "tests/support/message_of.h"

namespace tandem::support {

/// Message of make_scene() for a specification that it rejects.
inline std::string failure(const std::string& specification) {
    return message_of([&] { make_scene(specification); });
}

/// A mesh with a separate tetrahedron at each position.
inline Mesh tetrahedra_at(const std::vector<Eigen::Vector3d>& positions, double size = 1) {
    Mesh mesh;
    for (const auto& p : positions) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(),
                             {p, p + Eigen::Vector3d(size, 0, 0), p + Eigen::Vector3d(0, size, 0),
                              p + Eigen::Vector3d(0, 0, size)});
        mesh.tetrahedra.push_back({first, first + 1, first + 2, first + 3});
    }
    complete_mesh(mesh, "test");
    return mesh;
}

/// A box of cells x cells x cells cubes of six tetrahedra each; its vertices are perturbed.
inline Mesh shaken_box(std::uint32_t cells, Random& random) {
    Mesh mesh;
    mesh.name = "box";
    const auto side = cells + 1;
    for (std::uint32_t i = 0; i < side * side * side; ++i) {
        const Eigen::Vector3d lattice(i % side, i / side % side, i / side / side);
        const Eigen::Vector3d shake(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2),
                                    random.uniform(-0.2, 0.2));
        mesh.vertices.push_back((lattice + shake) / cells - Eigen::Vector3d::Constant(0.5));
    }
    constexpr std::uint32_t orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const std::uint32_t step[3] = {1, side, side * side};
    for (std::uint32_t cell = 0; cell < cells * cells * cells; ++cell) {
        const auto corner = cell % cells + side * (cell / cells % cells + side * (cell / cells / cells));
        for (const auto& order : orders) {
            const auto second = corner + step[order[0]];
            const auto third = second + step[order[1]];
            mesh.tetrahedra.push_back({corner, second, third, third + step[order[2]]});
        }
    }
    complete_mesh(mesh, "shaken box");
    return mesh;
}

/// The corner of a cube with edges of that length.
inline Mesh one_tetrahedron(double edge) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {edge, 0, 0}, {0, edge, 0}, {0, 0, edge}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    complete_mesh(mesh, "one tetrahedron");
    return mesh;
}

/// Gives each mesh of a scene a field: random pressures below 1, a third of which are 0.
inline void set_pressures(Scene& scene) {
    Random random(7);
    for (auto& mesh : scene.meshes) {
        mesh.pressures.resize(mesh.vertices.size());
        for (double& pressure : mesh.pressures) pressure = std::max(0.0, random.uniform(-0.5, 1));
    }
}

/// Crowded bodies of three meshes (1, 48 and 162 tetrahedra) with pressure fields; body 0 is fixed, body 1
/// deformable; two frames.
inline Scene crowd(std::uint64_t seed, std::uint32_t bodies, double spread) {
    Random random(seed);
    Scene scene;
    scene.name = scene.key = "crowd";
    scene.meshes = {shaken_box(3, random), shaken_box(2, random), one_tetrahedron(0.7)};
    set_pressures(scene);
    std::vector<std::array<Pose, 2>> poses(bodies);
    for (std::uint32_t i = 0; i < bodies; ++i) {
        scene.bodies.push_back({.mesh = i < 2 ? i : i % 3, .fixed = i == 0, .deformable = i == 1});
        for (auto& pose : poses[i])
            pose = {random.rotation(),
                    Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform()) * spread};
        if (i == 0) poses[i][1] = poses[i][0];
        if (i == 1) poses[i] = {};
    }
    scene.frame_count = 2;
    scene.frame = [poses, rest = scene.meshes[1].vertices](std::size_t frame) {
        Frame result;
        result.deformed.resize(poses.size());
        for (const auto& pose : poses) result.poses.push_back(pose[frame]);
        for (const auto& v : rest)
            result.deformed[1].push_back(Eigen::Vector3d(v.x() + 0.3, v.y() * (1 + 0.2 * v.x()),
                                                         v.z() + 0.1 * static_cast<double>(frame)));
        return result;
    };
    scene.digest = digest_of(scene);
    return scene;
}

/// The same scene, whose mesh m is moved by `distances[m]` along (1, -0.7, 0.4), and rigid bodies back by
/// their poses, which rounds.
inline Scene with_distant_meshes(Scene scene, const std::vector<double>& distances) {
    std::vector<Eigen::Vector3d> by;
    for (std::size_t mesh = 0; mesh < scene.meshes.size(); ++mesh) {
        by.push_back(distances[mesh] * Eigen::Vector3d(1, -0.7, 0.4));
        for (auto& vertex : scene.meshes[mesh].vertices) vertex += by[mesh];
    }
    scene.frame = [near = scene.frame, bodies = scene.bodies, by](std::size_t number) {
        auto frame = near(number);
        for (std::size_t body = 0; body < bodies.size(); ++body) {
            auto& pose = frame.poses[body];
            if (!bodies[body].deformable) pose.translation -= pose.rotation * by[bodies[body].mesh];
        }
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

/// Boxes in a row along x, each overlapping its neighbours. From frame to frame they move by `step` along x
/// and rotate. The first is fixed, the second deformable.
inline Scene procession(std::uint32_t bodies, std::size_t frames, double step) {
    Random random(17);
    Scene scene;
    scene.name = scene.key = "procession";
    scene.meshes = {shaken_box(2, random)};
    set_pressures(scene);
    scene.bodies.resize(bodies);
    scene.bodies[0].fixed = true;
    scene.bodies[1].deformable = true;
    scene.frame_count = frames;
    const auto vertices = scene.meshes.front().vertices;
    scene.frame = [bodies, step, vertices](std::size_t number) {
        Frame frame;
        frame.deformed.resize(bodies);
        const double displacement = step * static_cast<double>(number);
        for (std::uint32_t i = 0; i < bodies; ++i) {
            const Eigen::Vector3d position(0.8 * i + (i == 0 ? 0 : displacement), i % 3 * 0.1, 0);
            const Eigen::Quaterniond turn(
                Eigen::AngleAxisd(i == 0 ? 0 : displacement + 0.3 * i, Eigen::Vector3d::UnitZ()));
            frame.poses.push_back(i == 1 ? Pose{} : Pose{turn, position});
            if (i != 1) continue;
            for (const auto& vertex : vertices) frame.deformed[1].push_back(turn * vertex + position);
        }
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

/// The scene with all bodies moved.
inline Scene moved(Scene scene, const Eigen::Vector3d& offset) {
    scene.frame = [near = scene.frame, offset](std::size_t number) {
        auto frame = near(number);
        for (std::size_t body = 0; body < frame.poses.size(); ++body) {
            if (frame.deformed[body].empty()) frame.poses[body].translation += offset;
            for (auto& vertex : frame.deformed[body]) vertex += offset;
        }
        return frame;
    };
    return scene;
}

/// Two frames of a procession, whose fixed body meets the others in the second only. With the origin in the
/// middle of each frame, all bodies but the fixed one have the same coordinates in both.
inline Scene passing() {
    auto scene = procession(24, 2, 0);
    scene.frame = [near = scene.frame](std::size_t number) {
        auto frame = near(number);
        const Eigen::Vector3d offset(128.0 * static_cast<double>(number), 0, 0);
        for (auto& pose : frame.poses) pose.translation += offset;
        for (auto& vertex : frame.deformed[1]) vertex += offset;
        frame.poses[0].translation = {128 + 14, 0, 0};
        frame.poses[1] = {};
        return frame;
    };
    return scene;
}

/// Boxes around a centre, closer in some frames than in others: the numbers of pairs and contacts grow and
/// shrink from frame to frame, by small and large factors.
inline Scene breathing(std::size_t bodies) {
    constexpr std::array spreads{1.6, 1.3, 1.25, 0.7, 1.0, 0.68, 0.6, 1.7, 0.62};
    Random random(5);
    Scene scene;
    scene.name = scene.key = "breathing";
    scene.meshes = {shaken_box(2, random)};
    set_pressures(scene);
    scene.bodies.resize(bodies);
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < bodies; ++i)
        poses.push_back(
            {random.rotation(), Eigen::Vector3d(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5),
                                                random.uniform(-0.5, 0.5))});
    scene.frame_count = spreads.size();
    scene.frame = [poses, spreads](std::size_t number) {
        Frame frame;
        frame.deformed.resize(poses.size());
        for (const auto& pose : poses)
            frame.poses.push_back({pose.rotation, pose.translation * spreads[number]});
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

} // namespace tandem::support
