// SPDX-License-Identifier: MIT
#pragma once

#include "backends/registry.h"

#include <span>
#include <string>
#include <vector>

namespace tandem {

/// The devices of one cell, which share its work: one, or several named D+E.
using DeviceGroup = std::vector<Device*>;

/// The words between the pluses of "D+E".
std::vector<std::string> parts_of(const std::string& name);

/// Their names, "host" or "host+opencl:0".
std::string name_of(const DeviceGroup& devices);

/// The backends of those devices and of what is required, opened. No other is, so that it can neither break
/// nor delay the command, unless one of the names is of nothing that there is: then all are, for the message.
std::vector<BackendReport> open_backends(std::span<const std::string> names,
                                         std::span<const std::string> require);

/// Devices of the request, in its order: by number, by model or one of each model (device_models.h), "all".
/// Throws InputError that names the reason of absence and what there is.
std::vector<DeviceGroup> choose_devices(const std::vector<BackendReport>& backends,
                                        std::span<const std::string> names);

/// Whether all devices of "D+E+..." are there, or the back end of that name has any.
bool is_there(const std::string& name, const std::vector<BackendReport>& backends);

} // namespace tandem
