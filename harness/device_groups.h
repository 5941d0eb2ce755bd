// SPDX-License-Identifier: MIT
#pragma once

#include "backends/registry.h"

#include <span>
#include <string>
#include <vector>

namespace tandem {

/// The devices of one cell, which share its work: one, or several named D+E.
using DeviceGroup = std::vector<Device*>;

/// Their names, "host" or "host+opencl:0".
std::string name_of(const DeviceGroup& devices);

/// Devices of the request, in its order. Throws InputError that names the reason of absence and what there
/// is.
std::vector<DeviceGroup> choose_devices(const std::vector<BackendReport>& backends,
                                        std::span<const std::string> names);

} // namespace tandem
