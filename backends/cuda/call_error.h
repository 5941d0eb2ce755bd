// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/libraries.h"

#include <string_view>

namespace tandem::cuda {

/// Throws the error of a driver function `call` that returned `result` for the device of `info`: OutOfMemory
/// or DeviceError. `what` is the operation: "allocating 64 bytes".
[[noreturn]] void throw_call_error(const Libraries& libraries, const DeviceInfo& info, Result result,
                                   std::string_view call, std::string_view what);

} // namespace tandem::cuda
