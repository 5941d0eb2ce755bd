// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <span>

namespace tandem {

/// Every kernel file of the project, flattened and embedded (generated).
std::span<const KernelSource> kernel_sources();

/// The kernel file of that name, as in "algorithms/chunked/chunked.cl".
const KernelSource& kernel_source(std::string_view name);

} // namespace tandem
