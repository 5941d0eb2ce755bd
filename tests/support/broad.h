// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/broad_phase/broad_stage.h"
#include "algorithms/kernels/status.clh"
#include "tests/support/cells.h"
#include "tests/support/prepared_trees.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem::support {

constexpr std::uint32_t guard = 0xabcdabcd;

/// `positions`: per frame, those of each body. The bodies share a mesh and do not rotate.
inline Scene still_scene(Mesh mesh, const std::vector<std::vector<Eigen::Vector3d>>& positions) {
    Scene scene;
    scene.name = scene.key = "still";
    scene.meshes = {std::move(mesh)};
    scene.bodies.resize(positions.front().size());
    scene.frame_count = positions.size();
    scene.frame = [positions](std::size_t frame) {
        Frame result;
        result.deformed.resize(positions[frame].size());
        for (const auto& position : positions[frame])
            result.poses.push_back({Eigen::Quaterniond::Identity(), position});
        return result;
    };
    scene.digest = digest_of(scene);
    return scene;
}

inline Mesh one_tetrahedron() {
    Mesh mesh;
    mesh.name = "one";
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    complete_mesh(mesh, "one");
    return mesh;
}

/// Single tetrahedra scattered in a cube, at different positions in the two frames except for the fixed ones:
/// every `fixed_step`-th body.
inline Scene gravel(std::uint64_t seed, std::uint32_t bodies, double spread, std::uint32_t fixed_step) {
    Random random(seed);
    std::vector<std::vector<Eigen::Vector3d>> positions(2);
    for (std::uint32_t i = 0; i < bodies; ++i) {
        for (auto& frame : positions)
            frame.emplace_back(random.uniform() * spread, random.uniform() * spread,
                               random.uniform() * spread);
        if (i % fixed_step == 0) positions[1].back() = positions[0].back();
    }
    auto scene = still_scene(one_tetrahedron(), positions);
    for (std::uint32_t i = 0; i < bodies; i += fixed_step) scene.bodies[i].fixed = true;
    return scene;
}

/// Whether two root volumes overlap; touching counts.
template<class Real>
bool overlapping(const Real* a, const Real* b, std::size_t axes) {
    for (std::size_t axis = 0; axis < axes; ++axis)
        if (!(a[axis] <= b[axes + axis] && b[axis] <= a[axes + axis])) return false;
    return true;
}

template<class Real>
std::vector<BodyPair> expected_pairs(const PreparedTrees& on, const Scene& scene) {
    const auto k = static_cast<std::size_t>(on.geometry().k);
    const auto volumes = on.volumes<Real>();
    std::vector<BodyPair> pairs;
    for (const auto& pair : all_pairs(scene))
        if (overlapping(&volumes[pair.a * k], &volumes[pair.b * k], k / 2)) pairs.push_back(pair);
    return pairs;
}

/// The broad phase alone, on a refitted scene.
class Search {
public:
    Search(Device& device, const Scene& scene, const Geometry& geometry, std::uint32_t group_size,
           std::uint32_t groups)
        : scene_(scene),
          on_(device, scene, geometry, 4, device.info().max_group_size == 1 ? 1 : group_size),
          stage_(on_.bodies, on_.trees.volumes(), {on_.trees.group_size(), groups}),
          status_(device.allocate(STATUS_WORDS * 4, "status")) {}

    void go_to(std::size_t frame) { on_.update(scene_.frame(frame)); }
    void sort_by(std::size_t frame) { stage_.sort(scene_.frame(frame)); }

    std::vector<BodyPair> expected() const {
        return on_.geometry().precision == Precision::fp64 ? expected_pairs<double>(on_, scene_)
                                                           : expected_pairs<float>(on_, scene_);
    }

    /// The pairs found, sorted; their number in `count`. Checks that nothing is written past `capacity`.
    std::vector<BodyPair> found(std::uint32_t capacity, std::uint64_t& count) {
        const StageScope scope(on_.bodies.device(), Stage::broad);
        std::vector<std::uint32_t> rows(2 * (capacity + stage_.most_pairs() + 1), guard);
        const auto pairs = on_.bodies.device().allocate(rows.size() * 4, "pairs and guards");
        on_.bodies.device().upload(pairs, bytes_of(rows));
        on_.bodies.device().clear(status_, STATUS_WORDS * 4);
        stage_.launch(pairs, capacity, status_);
        std::vector<std::uint32_t> status(STATUS_WORDS);
        on_.bodies.device().download(status_, std::as_writable_bytes(std::span(status)));
        on_.bodies.device().download(pairs, std::as_writable_bytes(std::span(rows)));
        count = status[STATUS_BODY_PAIRS] | std::uint64_t{status[STATUS_BODY_PAIRS + 1]} << 32;
        const auto written = std::min<std::uint64_t>(count, capacity);
        std::vector<BodyPair> result;
        for (std::size_t i = 0; i < written; ++i) result.push_back({rows[2 * i], rows[2 * i + 1]});
        for (std::size_t i = 2 * written; i < rows.size(); ++i)
            EXPECT_EQ(rows[i], guard) << "word " << i << " of a buffer for " << capacity << " pairs";
        std::sort(result.begin(), result.end());
        return result;
    }

    void expect_right() {
        const auto right = expected();
        std::uint64_t count = 0;
        EXPECT_EQ(found(static_cast<std::uint32_t>(right.size()) + 3, count), right);
        EXPECT_EQ(count, right.size());
    }

private:
    const Scene& scene_;
    PreparedTrees on_;
    BroadStage stage_;
    Buffer status_;
};

} // namespace tandem::support
