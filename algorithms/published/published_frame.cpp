// SPDX-License-Identifier: MIT
#include "algorithms/published/published_frame.h"

#include "algorithms/bodies/pack.h"
#include "algorithms/sources.h"

#include <limits>

namespace tandem {

namespace {

/// Nodes that hold nothing, as many as fill `bytes`.
template<class Real>
std::vector<std::byte> empty_nodes(std::size_t bytes, int k) {
    std::vector<Real> values(bytes / sizeof(Real), std::numeric_limits<Real>::max());
    for (std::size_t i = 0; i < values.size(); ++i)
        if (i % static_cast<std::size_t>(k) >= static_cast<std::size_t>(k) / 2)
            values[i] = std::numeric_limits<Real>::lowest();
    const auto all = bytes_of(values);
    return {all.begin(), all.end()};
}

} // namespace

PublishedFrame::PublishedFrame(const Bodies& bodies, Hierarchy& hierarchy, LaunchShape shape)
    : bodies_(bodies), hierarchy_(hierarchy), device_(bodies.device()), group_size_(shape.group_size) {
    transform_kernel_ = device_.compile(kernel_source("algorithms/published/transform.cl"),
                                        "transform_vertices", row_defines(bodies.geometry(), group_size_));
    local_vertices_ =
        device_.allocate(bodies.vertex_total() * 4 * real_bytes(bodies.geometry()), "local vertices");
    vertex_bodies_ = device_.allocate(bodies.vertex_total() * 4, "vertex bodies");
}

PublishedFrame::Converted PublishedFrame::convert(const Frame& frame) const {
    const HostWork work(device_, Stage::preprocess, "convert bodies");
    const auto& scene = bodies_.scene();
    const auto& geometry = bodies_.geometry();
    Converted converted;
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
        const auto& mesh = bodies_.mesh(body);
        const bool deformable = scene.bodies[body].deformable;
        converted.rigid = converted.rigid || !deformable;
        pack_vertices(converted.vertices, geometry, mesh,
                      deformable ? frame.deformed[body] : scene.meshes[scene.bodies[body].mesh].vertices);
        converted.vertex_bodies.insert(converted.vertex_bodies.end(), mesh.vertices.size(), body);
        converted.tetrahedra.insert(converted.tetrahedra.end(), mesh.tetrahedra.begin(),
                                    mesh.tetrahedra.end());
        converted.boundary.insert(converted.boundary.end(), mesh.boundary.begin(), mesh.boundary.end());
    }
    converted.poses = bodies_.packed_poses(frame);
    const auto bytes = hierarchy_.nodes().bytes();
    converted.nodes = geometry.precision == Precision::fp64 ? empty_nodes<double>(bytes, geometry.k)
                                                            : empty_nodes<float>(bytes, geometry.k);
    return converted;
}

void PublishedFrame::upload(const Buffer& to, std::span<const std::byte> bytes) {
    const StageScope scope(device_, Stage::write);
    device_.upload(to, bytes, 0, true);
}

void PublishedFrame::download(const Buffer& from, std::vector<std::byte>& bytes) {
    const StageScope scope(device_, Stage::read);
    device_.download(from, bytes);
}

/// Scenes of deformable bodies have no transform stage: their vertices are in world coordinates already.
void PublishedFrame::transform(Converted& converted) {
    if (converted.rigid || bodies_.geometry().placement == Placement::exact)
        upload(bodies_.poses(), converted.poses);
    if (!converted.rigid) return;
    upload(local_vertices_, converted.vertices);
    upload(vertex_bodies_, bytes_of(converted.vertex_bodies));
    {
        const StageScope scope(device_, Stage::transform);
        const auto count = static_cast<std::uint32_t>(bodies_.vertex_total());
        const std::array<Argument, 5> arguments{local_vertices_, bodies_.vertices(), vertex_bodies_,
                                                bodies_.poses(), count};
        const auto groups = (std::uint64_t{count} + group_size_ - 1) / group_size_;
        device_.launch(transform_kernel_, {groups, group_size_}, arguments);
    }
    download(bodies_.vertices(), converted.vertices);
}

void PublishedFrame::refit(const Frame& frame, Converted& converted) {
    upload(hierarchy_.nodes(), converted.nodes);
    hierarchy_.refit(frame, true);
    download(hierarchy_.nodes(), converted.nodes);
    // Two copies of all nodes: the release kept its trees on the host and flattened them anew for the
    // traversal.
    std::vector<std::byte> host_trees;
    {
        const HostWork work(device_, Stage::postprocess, "store trees");
        host_trees = converted.nodes;
    }
    {
        const HostWork work(device_, Stage::preprocess, "flatten trees");
        converted.nodes = host_trees;
    }
    upload(hierarchy_.nodes(), converted.nodes);
}

/// In the order of the release: transform, refit, traversal, each with all its inputs uploaded again.
void PublishedFrame::update(const Frame& frame) {
    auto converted = convert(frame);
    transform(converted);
    upload(bodies_.vertices(), converted.vertices);
    upload(bodies_.tetrahedra(), bytes_of(converted.tetrahedra));
    upload(bodies_.row_table(), bodies_.packed_rows());
    refit(frame, converted);
    upload(bodies_.tetrahedra(), bytes_of(converted.tetrahedra));
    upload(bodies_.boundary(), bytes_of(converted.boundary));
    upload(bodies_.vertices(), converted.vertices);
}

} // namespace tandem
