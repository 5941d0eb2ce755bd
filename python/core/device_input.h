// SPDX-License-Identifier: MIT
#pragma once

#include "python/core/given_rows.h"

#include <map>
#include <vector>

namespace tandem::python {

/// Makes frames in memory of a device for a session. Kernels read arrays of that device in place. Arrays in
/// host memory are uploaded.
class DeviceInput {
public:
    /// Both must outlive it.
    DeviceInput(Device& device, const Scene& scene)
        : device_(device), scene_(scene), uploads_(scene.bodies.size() + 1) {}

    /// Without poses every body has the identity. Deformable bodies without vertices have those of their
    /// mesh. Throws InputError for a wrong number of rows.
    const DeviceFrame& frame(const std::optional<GivenRows>& poses,
                             const std::vector<std::optional<GivenRows>>& vertices);
    /// Addresses from which kernels read the last frame: poses (0 for none), then the vertices of each
    /// deformable body.
    std::vector<std::uintptr_t> addresses() const;

private:
    /// Uploaded rows.
    struct Upload {
        Buffer buffer;
        bool at_rest = false; ///< whether they are the vertices of the mesh
    };

    DeviceRows rows_of(const GivenRows& given, std::size_t columns, Upload& upload);
    DeviceRows uploaded(const void* data, std::size_t bytes, Precision precision, Upload& upload);
    DeviceRows at_rest(std::size_t body);
    Buffer adopted(void* data, std::size_t bytes);

    Device& device_;
    const Scene& scene_;
    std::vector<Upload> uploads_; ///< vertices of each body, then poses
    /// Adopted arrays by address and bytes. They are kept, because releasing one discards the device's data
    /// on commands of earlier frames.
    std::map<std::pair<void*, std::size_t>, Buffer> adopted_;
    DeviceFrame frame_;
    std::optional<void*>
        followed_; ///< last queue followed in this frame: arrays of one library share a stream
};

} // namespace tandem::python
