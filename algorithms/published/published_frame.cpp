// SPDX-License-Identifier: MIT
#include "algorithms/published/published_frame.h"

#include "algorithms/kernels/sources.h"

namespace tandem {

PublishedFrame::PublishedFrame(const Bodies& bodies, ChunkTrees& trees, LaunchShape shape,
                               const Settings& settings)
    : bodies_(bodies),
      trees_(trees),
      device_(bodies.device()),
      converter_(bodies, settings[parameters::convert],
                 static_cast<std::uint32_t>(settings[parameters::threads])),
      copies_(settings[parameters::copies]),
      group_size_(shape.group_size),
      host_trees_(trees) {
    compile_kernel(device_, transform_kernel_, row_defines(bodies.geometry(), group_size_));
    local_vertices_ =
        device_.allocate(bodies.vertex_total() * 4 * real_bytes(bodies.geometry()), "local vertices");
    vertex_bodies_ = device_.allocate(bodies.vertex_total() * 4, "vertex bodies");
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
void PublishedFrame::transform() {
    if (converted_.rigid || bodies_.geometry().placement == Placement::exact)
        upload(bodies_.poses(), converted_.poses);
    if (!converted_.rigid) return;
    upload(local_vertices_, std::span(converted_.vertices));
    upload(vertex_bodies_, std::as_bytes(std::span(converted_.vertex_bodies)));
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
    download(bodies_.vertices(), converted_.vertices);
}

void PublishedFrame::refit(const Frame& frame) {
    upload(bodies_.vertices(), std::span(converted_.vertices));
    upload(bodies_.tetrahedra(), std::as_bytes(std::span(converted_.tetrahedra)));
    upload(bodies_.row_table(), bodies_.packed_rows());
    upload(trees_.nodes(), std::span(converted_.nodes));
    trees_.refit(frame, true);
    download(trees_.nodes(), converted_.nodes);
    const HostWork work(device_, Stage::postprocess, "store trees");
    host_trees_.store(converted_.nodes, converter_);
}

void PublishedFrame::initialize(const Frame& frame) {
    {
        const HostWork work(device_, Stage::preprocess, "convert bodies");
        converted_ = converter_.convert(frame, trees_.nodes().bytes());
    }
    transform();
    refit(frame);
}

void PublishedFrame::prepare_walk(std::span<const BodyPair> pairs) {
    if (copies_ == TreeCopies::pair) {
        const HostWork work(device_, Stage::preprocess, "copy sub trees");
        host_trees_.copy(pairs, converter_);
    }
    {
        const HostWork work(device_, Stage::preprocess, "flatten trees");
        host_trees_.flatten(converted_.nodes, converter_);
    }
    upload(trees_.nodes(), std::span(converted_.nodes));
    upload(bodies_.tetrahedra(), std::as_bytes(std::span(converted_.tetrahedra)));
    upload(bodies_.boundary(), std::as_bytes(std::span(converted_.boundary)));
    upload(bodies_.vertices(), std::span(converted_.vertices));
}

} // namespace tandem
