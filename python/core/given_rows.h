// SPDX-License-Identifier: MIT
// An array of Python's as frames are read from it, taken by that protocol of its library which takes least
// time. After milliseconds of a frame the interpreter's own code and data have left the caches, so that each
// step of it counts.
#pragma once

#include "algorithms/device_frame.h"
#include "harness/plans/device_groups.h"

#include <memory>
#include <nanobind/nanobind.h>
#include <optional>

namespace tandem::python {

/// Rows beside each other, where Python has them.
struct GivenRows {
    void* data = nullptr;
    std::size_t rows = 0;
    Precision precision = Precision::fp64;
    bool on_device = false;         ///< in memory of the collider's device; or in the host's
    std::optional<void*> queue{};   ///< what has to be followed before they are read
    std::shared_ptr<void> keeper{}; ///< of the memory; dropped with the interpreter's lock
};

/// What an array has to be.
struct WantedRows {
    const DeviceGroup& devices;
    std::size_t columns;
    nanobind::handle& last_there;      ///< of a call: type of the last array that DLPack gave on the GPU
    std::optional<std::size_t> body{}; ///< whose vertices they are; none: they are poses

    std::string name() const;
};

/// What DLPack calls a device's memory, its kind and its number; none of OpenCL's, which no array library
/// takes.
std::optional<std::pair<int, int>> dlpack_device(const Device& device);

/// On the group's GPU, in whose memory nothing is looked at or moved; else in the host's, where they are of
/// float64: the array's own, or a copy. Throws InputError, or TypeError for numbers of another type: one line
/// that begins with the name.
GivenRows given_rows(nanobind::handle array, const WantedRows& wanted);

/// The same without a copy, and of the host's memory as memory of device host.
GivenRows device_rows(nanobind::handle array, const WantedRows& wanted);

} // namespace tandem::python
