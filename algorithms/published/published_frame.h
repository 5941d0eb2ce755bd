// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/kernels/launch_shape.h"
#include "algorithms/hierarchy/chunk_trees.h"
#include "algorithms/published/conversion.h"
#include "algorithms/published/host_trees.h"
#include "algorithms/published/transform.cl.h"
#include "algorithms/traversal.h"

namespace tandem {

/// Bodies and hierarchy in the data path of the paper's code. Every step converts all bodies on the host,
/// uploads vertices, transforms, and reads the vertices back. It then uploads tetrahedra and nodes, refits,
/// and reads the nodes back into the trees of the host. For the traversal it uploads everything again.
/// Buffers persist, which costs less than in the original.
class PublishedFrame {
public:
    /// `bodies` must not share data. `bodies` and `trees` must outlive this object. Of `settings` it takes
    /// convert, threads and copies.
    PublishedFrame(const Bodies& bodies, ChunkTrees& trees, LaunchShape shape, const Settings& settings);

    /// What the release counts as initialization: transform and refit, with their transfers and conversions.
    void initialize(const Frame& frame);
    /// What it does before a walk of these body pairs: copies of their trees, conversion and uploads.
    void prepare_walk(std::span<const BodyPair> pairs);

private:
    void transform();
    void refit(const Frame& frame);
    void upload(const Buffer& to, std::span<const std::byte> bytes);
    void download(const Buffer& from, std::span<std::byte> bytes);

    const Bodies& bodies_;
    ChunkTrees& trees_;
    Device& device_;
    Converter converter_;
    TreeCopies copies_;
    std::uint32_t group_size_;
    KernelOf<kernels::transform::TransformVertices> transform_kernel_;
    Buffer local_vertices_, vertex_bodies_; ///< vertices before the transform, and their bodies
    Converted converted_;                   ///< of the current frame
    HostTrees host_trees_;
};

} // namespace tandem
