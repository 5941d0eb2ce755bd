// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "python/core/frame_arrays.h"

#include <array>
#include <atomic>
#include <memory>

namespace tandem::python {

/// Rigid bodies have the identity as their pose, deformable bodies the vertices of their mesh.
Frame rest_frame(const Scene& scene);

/// Makes frames in host memory for a session, by one copy of arrays in host memory.
class HostInput {
public:
    /// `scene` must outlive it.
    HostInput(const Scene& scene, const Geometry& geometry);

    /// A frame of arrays that pass check_rows. What they leave out is that of `base`, or of rest_frame() if
    /// it is null. The next call but one overwrites the frame. Throws InputError for coordinates that do not
    /// pass check_range, and for rows without a rotation; last() is then the frame before.
    const Frame& frame(const FrameArrays& arrays, const Frame* base = nullptr);
    /// The last frame, which later calls do not overwrite as long as somebody holds it; null before the
    /// first.
    std::shared_ptr<const Frame> last() const { return frames_.front(); }

private:
    /// Makes a frame that nobody else holds the first of frames_.
    void take_unused();
    void fill(const FrameArrays& arrays, const Frame* base);
    void set_poses(const FrameArrays& arrays);
    void set_pose(std::size_t body, const double* row);
    void set_vertices(std::size_t body, const GivenRows& vertices);

    const Scene& scene_;
    Geometry geometry_;
    double limit_; ///< largest valid coordinate
    /// The last frame and one before it. Their memory is reused, unless an answer holds them.
    std::array<std::shared_ptr<Frame>, 2> frames_;
    std::atomic<std::size_t> out_of_range_ = 0; ///< number of coordinates of the last frame beyond limit_
};

} // namespace tandem::python
