// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

namespace tandem::host {

/// The kernels as C++, one work-item a group, one group after the other: reference device and sanitizer
/// target.
std::unique_ptr<Device> make_device();

} // namespace tandem::host
