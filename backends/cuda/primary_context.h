// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/driver.h"

namespace tandem::cuda {

/// Keeps a device's primary context alive.
class PrimaryContext {
public:
    PrimaryContext() = default;
    PrimaryContext(const PrimaryContext&) = delete;
    PrimaryContext& operator=(const PrimaryContext&) = delete;
    ~PrimaryContext() {
        if (driver_ != nullptr) driver_->cuDevicePrimaryCtxRelease_v2(handle_);
    }
    Result retain(const Driver& driver, DeviceHandle handle, Context& context) {
        const auto code = driver.cuDevicePrimaryCtxRetain(&context, handle);
        if (code == 0) driver_ = &driver;
        handle_ = handle;
        return code;
    }

private:
    const Driver* driver_ = nullptr;
    DeviceHandle handle_ = 0;
};

} // namespace tandem::cuda
