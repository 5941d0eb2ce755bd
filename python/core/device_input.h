// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/device_frame.h"

#include <map>
#include <nanobind/ndarray.h>
#include <optional>
#include <vector>

namespace tandem::python {

/// Rows of an array where Python has them.
struct GivenRows {
    void* data = nullptr;
    std::size_t rows = 0;
    Precision precision = Precision::fp64;
    bool on_device = false;                   ///< in memory of the collider's device; or in the host's
    std::optional<void*> queue{};             ///< what has to be waited for before they are read
    nanobind::ndarray<nanobind::ro> keeper{}; ///< of the memory; dropped with the interpreter's lock
};

/// What DLPack calls a device's memory, its kind and its number; none of OpenCL's, which no array library
/// takes.
std::optional<std::pair<int, int>> dlpack_device(const Device& device);

/// `value`: None; an array of the host's; a capsule of DLPack; or (address, rows, bits, stream) of
/// __cuda_array_interface__, whose shape is checked, with stream None where nothing is to be waited for.
/// Throws InputError, or TypeError for numbers of another type: one line that begins with `what`.
std::optional<GivenRows> given_rows(nanobind::handle value, std::size_t columns, const std::string& what,
                                    const Device& device);

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
};

} // namespace tandem::python
