// SPDX-License-Identifier: MIT
#pragma once

#include "backends/backend_report.h"

namespace tandem::cuda {

/// Every device of the driver, in its order. The reason is the error of the last that failed.
BackendReport discover();

/// A device over a host application's CUcontext and CUstream, which must outlive it. Throws DeviceError.
std::unique_ptr<Device> adopt(void* context, void* stream);

/// A device, given by its number, over a host application's CUstream of its primary context, which the CUDA
/// runtime uses. Null and CU_STREAM_LEGACY mean the default stream. The stream must outlive the device.
/// Throws DeviceError.
std::unique_ptr<Device> on_stream(std::size_t index, void* stream);

} // namespace tandem::cuda
