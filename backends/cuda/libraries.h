// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/driver.h"
#include "backends/cuda/nvrtc.h"

#include <memory>
#include <string>

namespace tandem::cuda {

/// The libraries that every device of the process shares. Throws DeviceError: one sentence on what is missing
/// and, without a compiler, the devices of the driver.
struct Libraries {
    Libraries();

    Driver driver;
    Nvrtc nvrtc;
};

/// The driver and its compiler, loaded once.
std::shared_ptr<Libraries> libraries();

/// ", " and the version of the kernel driver, from Linux or NVML; empty when neither reports it.
std::string kernel_driver();

} // namespace tandem::cuda
