// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/traversal.h"

namespace tandem {

/// Packs frames that lie in the device's memory: kernels read them there, and leave the bits that
/// Bodies::update uploads of the same frame in the host's memory.
class PackStage {
public:
    /// `bodies`, of Sharing::by_mesh, must outlive it. Throws InputError where the device has no double, or
    /// with placement=exact, whose drift the host bounds.
    PackStage(const Bodies& bodies, LaunchShape shape);

    /// Enqueues the packing of a frame that fits the scene (check_fits): a launch for the poses, one for each
    /// deformable body. Coordinates count from `origin`. Rows out of range go to STATUS_FLAWED of `status`.
    void launch(const DeviceFrame& frame, const Eigen::Vector3d& origin, const Buffer& status) const;

private:
    void pack_poses(const DeviceRows& rows, const Eigen::Vector3d& origin, const Buffer& status) const;
    void pack_vertices(std::size_t body, const DeviceRows& rows, const Eigen::Vector3d& origin,
                       const Buffer& status) const;
    Grid grid_over(std::uint64_t count) const;

    const Bodies& bodies_;
    LaunchShape shape_;
    double limit_; ///< of coordinates
    Kernel poses_, vertices_;
    Buffer places_;                           ///< OrderedMesh::numbers of meshes that deformable bodies have
    std::vector<std::uint32_t> first_places_; ///< by mesh, among these
};

} // namespace tandem
