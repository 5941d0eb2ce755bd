// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"
#include "backends/driver_report.h"

namespace tandem::opencl {

/// Every device of every platform, in the loader's order, and one sentence on what is missing.
struct Found {
    std::vector<std::unique_ptr<Device>> devices; ///< those that could be opened; never null
    std::vector<DriverReport> drivers;            ///< all that are registered
    std::string reason; ///< why there is none, or which devices and drivers failed; empty without errors
};

Found discover();

/// A device over a host application's cl_context, cl_device_id and in-order cl_command_queue, which must
/// outlive it. Timestamps work only if that queue was created with profiling.
std::unique_ptr<Device> adopt(void* context, void* device, void* queue);

} // namespace tandem::opencl
