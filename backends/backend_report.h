// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"
#include "backends/driver_report.h"

namespace tandem {

/// What a backend's discover() finds: its devices, or one sentence on why it has none.
struct BackendReport {
    std::string name{}; ///< "host", "opencl" or "cuda"; discover() of registry.h sets it
    /// In the backend's order, those that could be opened; never null.
    std::vector<std::unique_ptr<Device>> devices{};
    std::string reason{}; ///< why a device, a driver or the whole backend is missing; empty if none is
    std::vector<DriverReport> drivers{}; ///< of OpenCL, all that are registered; empty for other backends
};

} // namespace tandem
