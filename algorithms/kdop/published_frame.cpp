// SPDX-License-Identifier: MIT
// The frame as the paper's code has it (tvcg18.md 1.2, prox.md 2.11): every step converts all bodies on the
// host, uploads vertices, transforms, reads the vertices back, uploads tetrahedra and nodes, refits, reads
// the nodes back, and uploads everything again for the traversal. Buffers persist, which is kinder than the
// original.
#include "algorithms/kdop/device_scene.h"
#include "algorithms/kdop/pack.h"

#include <limits>
#include <numeric>

namespace tandem {

namespace {

template<class Real>
std::vector<std::byte> empty_nodes(std::uint64_t slots, int k) {
    std::vector<Real> values(slots * static_cast<std::uint64_t>(k), std::numeric_limits<Real>::max());
    for (std::size_t i = 0; i < values.size(); ++i)
        if (i % static_cast<std::size_t>(k) >= static_cast<std::size_t>(k) / 2)
            values[i] = std::numeric_limits<Real>::lowest();
    const auto bytes = bytes_of(values);
    return {bytes.begin(), bytes.end()};
}

} // namespace

void DeviceScene::update_published(const Frame& frame) {
    std::vector<std::byte> vertices, poses, nodes;
    std::vector<std::uint32_t> tetrahedra, vertex_bodies;
    std::vector<std::uint8_t> boundary;
    bool rigid = false;
    {
        const HostWork work(device_, Stage::preprocess, "convert bodies");
        for (std::uint32_t body = 0; body < scene_.bodies.size(); ++body) {
            const auto& mesh = meshes_[scene_.bodies[body].mesh];
            const bool deformable = scene_.bodies[body].deformable;
            rigid = rigid || !deformable;
            pack_vertices(vertices, geometry_, mesh,
                          deformable ? frame.deformed[body]
                                     : scene_.meshes[scene_.bodies[body].mesh].vertices);
            vertex_bodies.insert(vertex_bodies.end(), mesh.vertices.size(), body);
            tetrahedra.insert(tetrahedra.end(), mesh.tetrahedra.begin(), mesh.tetrahedra.end());
            boundary.insert(boundary.end(), mesh.boundary.begin(), mesh.boundary.end());
        }
        pack_poses(poses, frame);
        nodes = geometry_.precision == Precision::twice ? empty_nodes<double>(slots_, geometry_.k)
                                                        : empty_nodes<float>(slots_, geometry_.k);
    }
    const auto upload = [&](const Buffer& to, std::span<const std::byte> bytes) {
        const StageScope scope(device_, Stage::write);
        device_.upload(to, bytes, 0, true);
    };
    const auto download = [&](const Buffer& from, std::vector<std::byte>& bytes) {
        const StageScope scope(device_, Stage::read);
        device_.download(from, bytes);
    };
    // Scenes of deformable bodies have no transform stage: their vertices are in world coordinates already.
    if (rigid || geometry_.truth == Truth::pose) upload(poses_, poses);
    if (rigid) {
        upload(local_vertices_, vertices);
        upload(vertex_bodies_, bytes_of(vertex_bodies));
        {
            const StageScope scope(device_, Stage::transform);
            const auto count = static_cast<std::uint32_t>(vertex_total_);
            const std::array<Argument, 5> arguments{local_vertices_, vertices_, vertex_bodies_, poses_,
                                                    count};
            const auto group = refit_shape_.group_size;
            device_.launch(transform_kernel_, {(count + group - 1) / group, group}, arguments);
        }
        download(vertices_, vertices);
    }
    upload(vertices_, vertices);
    upload(tetrahedra_, bytes_of(tetrahedra));
    upload(bodies_, bytes_of(body_rows_));
    upload(nodes_, nodes);
    refit(true);
    download(nodes_, nodes);
    std::vector<std::byte> host_trees;
    {
        const HostWork work(device_, Stage::postprocess, "store trees");
        host_trees = nodes;
    }
    {
        const HostWork work(device_, Stage::preprocess, "flatten trees");
        nodes = host_trees;
    }
    upload(nodes_, nodes);
    upload(tetrahedra_, bytes_of(tetrahedra));
    upload(boundary_, bytes_of(boundary));
    upload(vertices_, vertices);
}

} // namespace tandem
