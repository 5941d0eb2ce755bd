// SPDX-License-Identifier: MIT
#pragma once

#include "python/core/frame_arrays.h"

namespace tandem::python {

/// Rigid bodies have the identity as their pose, deformable bodies the vertices of their mesh.
Frame rest_frame(const Scene& scene);

/// Makes frames in host memory for a session, by one copy of arrays in host memory.
class HostInput {
public:
    /// `scene` must outlive it.
    HostInput(const Scene& scene, Precision precision);

    /// A frame of arrays that pass check_rows. The next call overwrites it. Throws InputError for coordinates
    /// that do not pass check_range, and for rows without a rotation.
    const Frame& frame(const FrameArrays& arrays);

private:
    void set_poses(const GivenRows& poses);
    void set_vertices(std::size_t body, const GivenRows& vertices);

    const Scene& scene_;
    Precision precision_;
    double limit_;                 ///< largest valid coordinate
    Frame frame_;                  ///< its memory is reused for each frame
    std::size_t out_of_range_ = 0; ///< number of coordinates of frame_ beyond limit_
};

} // namespace tandem::python
