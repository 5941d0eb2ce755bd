// SPDX-License-Identifier: MIT
#pragma once

#include "backends/backend_report.h"

namespace tandem::opencl {

/// Every device of every platform, in the loader's order. The reason names the devices and drivers that
/// failed.
BackendReport discover();

/// A device over a host application's cl_context, cl_device_id and in-order cl_command_queue, which must
/// outlive it. Throws InputError for another queue or a null pointer. Timestamps work only if that queue was
/// created with profiling.
std::unique_ptr<Device> adopt(void* context, void* device, void* queue);

} // namespace tandem::opencl
