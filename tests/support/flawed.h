// SPDX-License-Identifier: MIT
// Scenes with tetrahedra of zero volume and with coordinates that are not finite.
#pragma once

#include "geometry/volume.h"
#include "scenes/contact.h"
#include "tests/support/scenes.h"

#include <algorithm>
#include <limits>

namespace tandem::support {

/// Overlapping boxes: bodies 0 (fixed) and 1 are rigid and share a mesh; body 2 is deformable, has its own
/// mesh and moves a little in every frame. A side has `cells` cubes of six tetrahedra each.
inline Scene boxes_scene(std::uint32_t cells, std::size_t frames) {
    Random random(cells);
    Scene scene;
    scene.name = scene.key = "boxes";
    scene.meshes = {shaken_box(cells, random), shaken_box(cells, random)};
    scene.bodies = {{.mesh = 0, .fixed = true}, {.mesh = 0}, {.mesh = 1, .deformable = true}};
    scene.frame_count = std::max<std::size_t>(frames, 4);
    scene.frame = [rest = scene.meshes[1].vertices](std::size_t index) {
        const double step = 0.01 * static_cast<double>(index);
        Frame frame;
        frame.poses = {{}, {Eigen::Quaterniond::Identity(), {0.4 + step, 0.3, 0.2}}, {}};
        frame.deformed.resize(3);
        for (const auto& v : rest)
            frame.deformed[2].push_back(v + Eigen::Vector3d(0.2, -0.3 + step, 0.4 + 0.1 * v.x()));
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

/// The scene with these frames, numbered from `first`.
inline Scene with_frames(Scene scene, std::vector<Frame> frames, std::size_t first = 0) {
    scene.frame_count = first + frames.size();
    scene.frame = [frames = std::move(frames), first](std::size_t index) { return frames.at(index - first); };
    return scene;
}

/// Collapses a corner of the tetrahedron onto another of its corners: it and possibly its neighbours become
/// flat.
inline void make_flat(const Mesh& mesh, std::vector<Eigen::Vector3d>& vertices, std::uint32_t tetrahedron) {
    const auto& t = mesh.tetrahedra[tetrahedron];
    vertices[t[3]] = vertices[t[0]];
}

inline bool is_flat(const Mesh& mesh, const std::vector<Eigen::Vector3d>& vertices,
                    std::uint32_t tetrahedron) {
    TetraCorners corners;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned axis = 0; axis < 3; ++axis)
            corners[i][axis] = vertices[mesh.tetrahedra[tetrahedron][i]][axis];
    return !has_volume(corners);
}

/// Tetrahedra that contain the vertex, ascending.
inline std::vector<std::uint32_t> around(const Mesh& mesh, std::uint32_t vertex) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (std::find(mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end(), vertex)
            != mesh.tetrahedra[t].end())
            result.push_back(t);
    return result;
}

/// Whether the frame skips a tetrahedron of the pair.
inline bool is_skipped(const Frame& frame, const Pair& pair) {
    const auto contains = [&](std::uint32_t body, std::uint32_t tetrahedron) {
        return !frame.skipped.empty()
               && std::binary_search(frame.skipped[body].begin(), frame.skipped[body].end(), tetrahedron);
    };
    return contains(pair.body_a, pair.tet_a) || contains(pair.body_b, pair.tet_b);
}

} // namespace tandem::support
