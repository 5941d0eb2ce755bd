// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

namespace tandem {

/// What one backend has, or the one sentence why it has nothing.
struct BackendReport {
    std::string name;
    std::vector<std::unique_ptr<Device>> devices;
    std::string reason;
};

/// Looks for the devices of every backend. Never throws.
std::vector<BackendReport> discover();

} // namespace tandem
