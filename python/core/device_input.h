// SPDX-License-Identifier: MIT
#pragma once

#include "python/core/given_rows.h"

#include <map>
#include <vector>

namespace tandem::python {

/// Frames of a scene as a session takes them from memory of its device: arrays there are read where they are,
/// those of the host's memory are brought to it.
class DeviceInput {
public:
    /// Both must outlive it.
    DeviceInput(Device& device, const Scene& scene)
        : device_(device), scene_(scene), uploads_(scene.bodies.size() + 1) {}

    /// Without poses every body is at the identity, and deformable ones without vertices have their mesh's.
    /// Throws InputError for a wrong number of rows.
    const DeviceFrame& frame(const std::optional<GivenRows>& poses,
                             const std::vector<std::optional<GivenRows>>& vertices);
    /// Where kernels read the last frame: its poses, 0 for none, and the vertices of each deformable body.
    std::vector<std::uintptr_t> addresses() const;

private:
    /// Rows that were brought to the device, and whether they are the mesh's own.
    struct Upload {
        Buffer buffer;
        bool at_rest = false;
    };

    DeviceRows rows_of(const GivenRows& given, std::size_t columns, Upload& upload);
    DeviceRows uploaded(const void* data, std::size_t bytes, Precision precision, Upload& upload);
    DeviceRows at_rest(std::size_t body);
    Buffer adopted(void* data, std::size_t bytes);

    Device& device_;
    const Scene& scene_;
    std::vector<Upload> uploads_; ///< of each body's vertices, then of poses
    /// Handles stay, since one that goes takes with it what the device keeps of earlier frames' commands.
    std::map<std::pair<void*, std::size_t>, Buffer> adopted_;
    DeviceFrame frame_;
    std::optional<void*> followed_; ///< in this frame: arrays of a library share its stream
};

} // namespace tandem::python
