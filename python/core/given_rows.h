// SPDX-License-Identifier: MIT
// Access to the rows of a Python array by the fastest protocol that its library supports. After milliseconds
// of a frame, code and data of the interpreter are no longer in the caches, so that each Python call is slow.
#pragma once

#include "algorithms/bodies/device_frame.h"
#include "harness/plans/device_groups.h"

#include <memory>
#include <nanobind/nanobind.h>
#include <optional>

namespace tandem::python {

/// Contiguous rows in memory of a Python array.
struct GivenRows {
    void* data = nullptr;
    std::size_t rows = 0;
    Precision precision = Precision::fp64;
    bool on_device = false;        ///< in memory of the collider's device; false: in host memory
    std::optional<void*> queue{};  ///< the device must follow this queue before it reads the rows
    std::shared_ptr<void> owner{}; ///< of the memory; release it with the interpreter's lock
};

/// Requirements on an array, and the context of the call.
struct WantedRows {
    const DeviceGroup& devices;
    std::size_t columns;
    nanobind::handle& last_gpu_type;   ///< type of the last GPU array of this call that came by DLPack
    bool of_next = false;              ///< whether they are of the frame's successor
    std::optional<std::size_t> body{}; ///< the body whose vertices they are; none: they are poses

    std::string name() const;
};

/// DLPack's type and number of a device. None for OpenCL devices, whose memory no array library accepts.
std::optional<std::pair<int, int>> dlpack_device(const Device& device);

/// Rows on the group's GPU, which are neither read nor copied, or rows of float64 in host memory: those of
/// the array or a copy. Throws InputError, or TypeError for numbers of another type; messages are one line
/// that begins with the name.
GivenRows given_rows(nanobind::handle array, const WantedRows& wanted);

/// The same without a copy. Host memory counts as memory of device host.
GivenRows device_rows(nanobind::handle array, const WantedRows& wanted);

} // namespace tandem::python
