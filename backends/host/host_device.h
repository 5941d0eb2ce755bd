// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

namespace tandem::host {

/// The kernels as C++, one work-item a group, groups side by side on as many threads as set_threads() says:
/// the device of machines without another, reference and sanitizer target.
/// Kernels with lanes are those of the highest level of x86-64 that the processor has, or of `most_level` if
/// that is lower: 2, 3 or 4. Results have equal bits at every level.
std::unique_ptr<Device> make_device(int most_level = 4);

} // namespace tandem::host
