// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"
#include "backends/opencl/cl.h"

#include <string_view>

namespace tandem::opencl {

/// Throws the error of an OpenCL function `call` that returned `code` for the device of `info`: OutOfMemory
/// or DeviceError. `what` is the operation: "allocating 64 bytes".
[[noreturn]] void throw_call_error(const DeviceInfo& info, cl_int code, std::string_view call,
                                   std::string_view what);

} // namespace tandem::opencl
