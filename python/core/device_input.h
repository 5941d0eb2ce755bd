// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "python/core/frame_arrays.h"

#include <vector>

namespace tandem::python {

/// Makes frames in memory of a device for a session. Kernels read arrays of that device in place. Arrays in
/// host memory are uploaded.
class DeviceInput {
public:
    /// Both must outlive it.
    DeviceInput(Device& device, const Scene& scene) : device_(device), scene_(scene) {}

    /// The frame of arrays that pass check_rows, and its successor if there is one. The next call overwrites
    /// them.
    DeviceFrameInput frames(const Input& input);
    /// The stream of the last frame's arrays; none if their library orders the device's queue itself.
    std::optional<void*> followed() const { return followed_; }
    /// Addresses from which kernels read the last frame: poses (0 for none), then the vertices of each
    /// deformable body. Those of its successor follow.
    std::vector<std::uintptr_t> addresses() const;

private:
    /// Uploaded rows.
    struct Upload {
        Buffer buffer;
        bool at_rest = false; ///< whether they are the vertices of the mesh
    };
    /// A frame, and the memory of its rows from the host.
    struct Rows {
        DeviceFrame frame;
        std::vector<Upload> uploads; ///< vertices of each body, then poses
    };

    void read(const FrameArrays& arrays, Rows& rows);
    DeviceRows rows_of(const GivenRows& given, std::size_t columns, Upload& upload);
    DeviceRows uploaded(const void* data, std::size_t bytes, Precision precision, Upload& upload);
    DeviceRows at_rest(std::size_t body, Upload& upload);

    Device& device_;
    const Scene& scene_;
    Rows frame_, next_;
    bool has_next_ = false; ///< whether the last frame had a successor
    std::optional<void*>
        followed_; ///< last queue followed in this call: arrays of one library share a stream
};

} // namespace tandem::python
