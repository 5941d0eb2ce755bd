// SPDX-License-Identifier: MIT
// The devices that the driver lists, and their properties.
#pragma once

#include "backends/cuda/libraries.h"

#include <string>

namespace tandem::cuda {

/// Properties of a device; they are constant.
struct Description {
    DeviceInfo info;
    int capability = 0;       ///< compute capability, as 90 for 9.0
    int threads_per_unit = 0; ///< that a multiprocessor can hold at once
};

/// Queries the properties of a device; `id` becomes `info.id`. Throws DeviceError when a query fails whose
/// value is not optional.
Description describe(const Libraries& libraries, DeviceHandle handle, std::string id);

/// The number of devices of the driver. Throws DeviceError.
int device_count(const Driver& driver);

/// The device at `index`, which counts from 0. Throws DeviceError.
DeviceHandle device_handle(const Driver& driver, int index);

} // namespace tandem::cuda
