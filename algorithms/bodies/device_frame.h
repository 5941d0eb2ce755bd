// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "backends/device.h"
#include "scenes/scene.h"

#include <cstdint>
#include <vector>

namespace tandem {

/// Consecutive rows of numbers in a device's memory. Buffer::adopt makes a buffer from an application's
/// memory.
struct DeviceRows {
    Buffer buffer;                         ///< empty: no rows
    Precision precision = Precision::fp64; ///< of its numbers
};

/// A frame in the memory of the session's device. Commands that write it must come before run() in the order
/// of the device's queue (Device::queue, Device::follow). run() has read it when it returns.
struct DeviceFrame {
    /// One row per body, tx ty tz qw qx qy qz: x_world = R(q) x_mesh + t. q is normalised; it must be
    /// finite and not 0. Rows of deformable bodies are not read. Empty: all bodies at the
    /// identity.
    DeviceRows poses;
    /// One entry per body. Deformable bodies: x y z of each vertex in world coordinates, in the order of the
    /// mesh. Other bodies: empty. No entries at all: no body is deformable.
    std::vector<DeviceRows> deformed;
    std::vector<std::vector<std::uint32_t>> skipped{}; ///< see Frame::skipped; in the host's memory
};

/// The pose of a row tx ty tz qw qx qy qz, with normalised quaternion (base/quaternion.h). Throws InputError
/// that names row `body` if it is not finite or has no rotation.
Pose pose_of_row(const double* row, std::size_t body);

} // namespace tandem
