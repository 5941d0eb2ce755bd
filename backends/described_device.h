// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

namespace tandem {

/// A device that another process has: what it is, to plan with. Every command throws std::logic_error.
std::unique_ptr<Device> described_device(DeviceInfo info);

} // namespace tandem
