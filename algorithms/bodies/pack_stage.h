// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/bodies/pack_frame.cl.h"
#include "algorithms/kernels/launch_shape.h"

namespace tandem {

/// Packs frames in the device's memory with kernels. The result has the bits that Bodies::update uploads for
/// the same frame in the host's memory.
class PackStage {
public:
    /// `bodies` must have Sharing::by_mesh and outlive this. Throws InputError if the device has no double,
    /// and with placement=exact, because only the host bounds drift.
    PackStage(const Bodies& bodies, LaunchShape shape);

    /// Enqueues the packing of a frame that passes check_fits, and of its successor: one launch for the
    /// poses, and one per deformable body; a third for the arcs. Coordinates are made relative to `origin`.
    /// Adds rows out of range to STATUS_FLAWED of `status`.
    void launch(const DeviceFrameInput& input, const Eigen::Vector3d& origin, const Buffer& status) const;

private:
    void pack(const DeviceFrame& frame, const Buffer& poses, const Buffer& vertices,
              const Eigen::Vector3d& origin, const Buffer& status) const;
    void pack_poses(const DeviceRows& rows, const Buffer& poses, const Eigen::Vector3d& origin,
                    const Buffer& status) const;
    void pack_arcs(const DeviceRows& rows, const DeviceRows& next_rows) const;
    void pack_vertices(std::size_t body, const DeviceRows& rows, const Buffer& vertices,
                       const Eigen::Vector3d& origin, const Buffer& status) const;
    Grid grid_over(std::uint64_t count) const;

    const Bodies& bodies_;
    LaunchShape shape_;
    double limit_;                          ///< largest magnitude of a coordinate
    std::vector<std::uint32_t> deformable_; ///< bodies
    KernelOf<kernels::pack_frame::PackPoses> poses_;
    KernelOf<kernels::pack_frame::PackVertices> vertices_;
    KernelOf<kernels::pack_frame::PackArcs> arcs_; ///< null without motion
    Buffer shifts_;    ///< Scene::shifts by body; empty unless the scene is centred
    Buffer indices_;   ///< OrderedMesh::numbers of the meshes of deformable bodies
    Buffer pressures_; ///< of the vertices of indices_; empty unless vertices carry them
    std::vector<std::uint32_t> first_indices_; ///< by mesh, in indices_
};

} // namespace tandem
