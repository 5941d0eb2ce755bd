// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

namespace tandem::cuda {

/// Every device of the driver, in its order, or the sentence why there is none.
struct Found {
    std::vector<std::unique_ptr<Device>> devices;
    std::string reason;
};

Found discover();

/// A device over a host application's CUcontext and CUstream, which must outlive it. Throws DeviceError.
std::unique_ptr<Device> adopt(void* context, void* stream);

} // namespace tandem::cuda
