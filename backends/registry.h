// SPDX-License-Identifier: MIT
#pragma once

#include "backends/backend_report.h"

#include <span>

namespace tandem {

/// Finds the devices of every backend. Never throws.
std::vector<BackendReport> discover();

/// Finds the devices of the backends that `wanted` names: by a device or a model ("cuda:0", "cuda:H100"),
/// among the devices of a cell ("host+cuda:0"), by the backend's own name, or as "all" or "each". Other
/// backends are neither loaded nor reported.
std::vector<BackendReport> discover(std::span<const std::string> wanted);

/// Returns `found` and the backends that it lacks.
std::vector<BackendReport> add_missing_backends(std::vector<BackendReport> found);

} // namespace tandem
