// SPDX-License-Identifier: MIT
#include "algorithms/published/published_frame.h"

#include "algorithms/kernels/sources.h"

namespace tandem {

PublishedFrame::PublishedFrame(const Bodies& bodies, Hierarchy& hierarchy, LaunchShape shape,
                               Conversion conversion, std::uint32_t threads)
    : bodies_(bodies),
      hierarchy_(hierarchy),
      device_(bodies.device()),
      converter_(bodies, conversion, threads),
      group_size_(shape.group_size) {
    compile_kernel(device_, transform_kernel_, row_defines(bodies.geometry(), group_size_));
    local_vertices_ =
        device_.allocate(bodies.vertex_total() * 4 * real_bytes(bodies.geometry()), "local vertices");
    vertex_bodies_ = device_.allocate(bodies.vertex_total() * 4, "vertex bodies");
}

Converted PublishedFrame::convert(const Frame& frame) {
    const HostWork work(device_, Stage::preprocess, "convert bodies");
    return converter_.convert(frame, hierarchy_.nodes().bytes());
}

void PublishedFrame::upload(const Buffer& to, std::span<const std::byte> bytes) {
    const StageScope scope(device_, Stage::write);
    device_.upload(to, bytes, 0, true);
}

void PublishedFrame::download(const Buffer& from, std::span<std::byte> bytes) {
    const StageScope scope(device_, Stage::read);
    device_.download(from, bytes);
}

/// Scenes without rigid bodies have no transform stage, because their vertices are already in world
/// coordinates.
void PublishedFrame::transform(Converted& converted) {
    if (converted.rigid || bodies_.geometry().placement == Placement::exact)
        upload(bodies_.poses(), converted.poses);
    if (!converted.rigid) return;
    upload(local_vertices_, std::span(converted.vertices));
    upload(vertex_bodies_, std::as_bytes(std::span(converted.vertex_bodies)));
    {
        const StageScope scope(device_, Stage::transform);
        const auto count = static_cast<std::uint32_t>(bodies_.vertex_total());
        const kernels::transform::TransformVertices arguments{.vertices = local_vertices_,
                                                              .world = bodies_.vertices(),
                                                              .vertex_bodies = vertex_bodies_,
                                                              .poses = bodies_.poses(),
                                                              .vertex_count = count};
        const auto groups = (std::uint64_t{count} + group_size_ - 1) / group_size_;
        device_.launch(transform_kernel_, {groups, group_size_}, arguments);
    }
    download(bodies_.vertices(), converted.vertices);
}

void PublishedFrame::refit(const Frame& frame, Converted& converted) {
    upload(hierarchy_.nodes(), std::span(converted.nodes));
    hierarchy_.refit(frame, true);
    download(hierarchy_.nodes(), converted.nodes);
    // Two copies of all nodes: the release keeps its trees on the host and flattens them again for the
    // traversal.
    Converted::Array<std::byte> host_trees;
    {
        const HostWork work(device_, Stage::postprocess, "store trees");
        host_trees = converter_.copy(converted.nodes);
    }
    {
        const HostWork work(device_, Stage::preprocess, "flatten trees");
        converted.nodes = converter_.copy(host_trees);
    }
    upload(hierarchy_.nodes(), std::span(converted.nodes));
}

/// Follows the order of the release: transform, refit, traversal, each with all its inputs uploaded again.
void PublishedFrame::update(const Frame& frame) {
    auto converted = convert(frame);
    transform(converted);
    upload(bodies_.vertices(), std::span(converted.vertices));
    upload(bodies_.tetrahedra(), std::as_bytes(std::span(converted.tetrahedra)));
    upload(bodies_.row_table(), bodies_.packed_rows());
    refit(frame, converted);
    upload(bodies_.tetrahedra(), std::as_bytes(std::span(converted.tetrahedra)));
    upload(bodies_.boundary(), std::as_bytes(std::span(converted.boundary)));
    upload(bodies_.vertices(), std::span(converted.vertices));
}

} // namespace tandem
