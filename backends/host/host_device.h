// SPDX-License-Identifier: MIT
#pragma once

#include "backends/backend_report.h"

#include <set>

namespace tandem::host {

/// The host device: it runs the kernels compiled as C++, one work-item a group, groups in parallel on
/// set_threads() threads. It serves machines without another device, the reference and sanitizers.
/// Kernels with lanes use the highest compiled level of x86-64 that the processor has, at most `max_level`
/// (2, 3 or 4). Results have equal bits at every level. Throws DeviceError when the processor has no compiled
/// level.
std::unique_ptr<Device> make_device(int max_level = 4);

/// The one host device.
BackendReport discover();

/// The levels of x86-64 that kernels with lanes are compiled for (CMake's TANDEM_LEVELS); empty when they are
/// compiled like all other code.
std::set<int> compiled_levels();

} // namespace tandem::host
