// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <span>

namespace tandem {

/// What one backend has, or the one sentence why it has nothing.
struct BackendReport {
    std::string name;
    std::vector<std::unique_ptr<Device>> devices;
    std::string reason;
};

/// Looks for the devices of every backend. Never throws.
std::vector<BackendReport> discover();

/// The same of those backends only that `wanted` names: by a device or a model ("cuda:0", "cuda:H100"), among
/// the devices of a cell ("host+cuda:0"), by the backend's own name, or as "all" or "each". Of the others
/// nothing is loaded or reported.
std::vector<BackendReport> discover(std::span<const std::string> wanted);

/// `found`, and the backends that it lacks.
std::vector<BackendReport> with_others(std::vector<BackendReport> found);

} // namespace tandem
