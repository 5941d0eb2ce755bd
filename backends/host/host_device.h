// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <set>

namespace tandem::host {

/// The kernels as C++, one work-item a group, groups side by side on as many threads as set_threads() says:
/// the device of machines without another, reference and sanitizer target.
/// Kernels with lanes are those of the highest level of x86-64 that the processor has, or of `most_level` if
/// that is lower: 2, 3 or 4, as far as they are compiled. Results have equal bits at every level. Throws
/// DeviceError where the processor has none of the compiled ones.
std::unique_ptr<Device> make_device(int most_level = 4);

/// The levels of x86-64 that kernels with lanes are compiled for (CMake's TANDEM_LEVELS); none where they are
/// compiled as everything else is.
std::set<int> compiled_levels();

} // namespace tandem::host
