// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/bodies/pack_frame.cl.h"
#include "algorithms/kernels/launch_shape.h"

#include <memory>

namespace tandem {

/// Packs the poses of frames in the host's memory with a kernel: the host only copies seven doubles a body.
/// The result has the bits that Bodies::update_poses uploads.
class PoseStage {
public:
    /// Null where the host packs faster: on device host, whose kernels the host runs, and for few bodies,
    /// which it packs in the time of a launch. Also null where it must: without double on the device, with
    /// placement=exact or motion=linear, whose poses have drift or arcs, with Sharing::none, and without
    /// memory for the rows. `bodies` must outlive the result.
    static std::unique_ptr<PoseStage> make(const Bodies& bodies, LaunchShape shape);

    /// Enqueues the upload and the packing of the frame's poses. `all`: as for Bodies::update_poses.
    void launch(const Frame& frame, bool all);

private:
    PoseStage(const Bodies& bodies, LaunchShape shape);

    const Bodies& bodies_;
    Grid grid_;
    std::vector<double> numbers_; ///< tx ty tz qw qx qy qz of each body
    Buffer rows_;
    KernelOf<kernels::pack_frame::PackUnitPoses> kernel_;
};

} // namespace tandem
