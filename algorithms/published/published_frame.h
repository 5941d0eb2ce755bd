// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/kernels/launch_shape.h"
#include "algorithms/hierarchy/hierarchy.h"
#include "algorithms/published/conversion.h"
#include "algorithms/published/transform.cl.h"
#include "algorithms/traversal.h"

namespace tandem {

/// Bodies and hierarchy in the data path of the paper's code. Every step converts all bodies on the host,
/// uploads vertices, transforms, and reads the vertices back. It then uploads tetrahedra and nodes, refits,
/// reads the nodes back, and uploads everything again for the traversal. Buffers persist, which costs less
/// than in the original.
class PublishedFrame {
public:
    /// `bodies` must not share data. `bodies` and `hierarchy` must outlive this object. `conversion`,
    /// `threads`: as for Converter.
    PublishedFrame(const Bodies& bodies, Hierarchy& hierarchy, LaunchShape shape,
                   Conversion conversion = Conversion::serial, std::uint32_t threads = 0);

    void update(const Frame& frame);

private:
    Converted convert(const Frame& frame);
    void transform(Converted& converted);
    void refit(const Frame& frame, Converted& converted);
    void upload(const Buffer& to, std::span<const std::byte> bytes);
    void download(const Buffer& from, std::span<std::byte> bytes);

    const Bodies& bodies_;
    Hierarchy& hierarchy_;
    Device& device_;
    Converter converter_;
    std::uint32_t group_size_;
    KernelOf<kernels::transform::TransformVertices> transform_kernel_;
    Buffer local_vertices_, vertex_bodies_; ///< vertices before the transform, and their bodies
};

} // namespace tandem
