// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "backends/device.h"
#include "scenes/scene.h"

#include <cstdint>
#include <vector>

namespace tandem {

/// Rows of numbers in a device's memory, one behind the other; Buffer::adopt makes one of an application's.
struct DeviceRows {
    Buffer buffer;                         ///< empty: there are none
    Precision precision = Precision::fp64; ///< of its numbers
};

/// A frame whose numbers are in memory of the device that a session works on; they have to be there when
/// run() is called, as far as commands of the device's queue go (Device::queue, Device::follow), and have
/// been read when it returns.
struct DeviceFrame {
    /// Of each body tx ty tz qw qx qy qz: x_world = R(q) x_mesh + t, where q, of any length whose square is
    /// between 1e-300 and 1e300, is made a unit quaternion. Rows of deformable bodies are not read. None:
    /// every body at the identity.
    DeviceRows poses;
    /// One a body: x y z of each vertex of a deformable body, in the world, as its mesh numbers them; none of
    /// a rigid one.
    std::vector<DeviceRows> deformed;
    std::vector<std::vector<std::uint32_t>> skipped{}; ///< as Frame::skipped, in the host's memory
};

/// The pose of a row tx ty tz qw qx qy qz, whose quaternion it makes a unit one: in the order of operations
/// that pack_frame.cl has. Throws InputError that names row `body` where it is not finite or has no rotation.
Pose pose_of_row(const double* row, std::size_t body);

} // namespace tandem
