// SPDX-License-Identifier: MIT
#pragma once

#include "backends/registry.h"

#include <span>
#include <string>
#include <vector>

namespace tandem {

/// The device of a command that names none.
inline constexpr const char* default_device = "opencl:0";

/// The devices of one cell, which split its work: one, or several named D+E.
using DeviceGroup = std::vector<Device*>;

/// The names in "D+E", without the pluses.
std::vector<std::string> parts_of(const std::string& name);

/// The name of the group, "host" or "host+opencl:0".
std::string name_of(const DeviceGroup& devices);

/// Opens the backends of the named and the required devices. No other backend is opened, so that it can
/// neither break nor delay the command. When a name is unknown, all backends are opened for the error
/// message.
std::vector<BackendReport> open_backends(std::span<const std::string> names,
                                         std::span<const std::string> require);

/// The devices of the names, in order: by number, by model or one of each model (see device_models.h), or
/// "all". Throws InputError that names the reason of absence and the available devices.
std::vector<DeviceGroup> choose_devices(const std::vector<BackendReport>& backends,
                                        std::span<const std::string> names);

/// Whether all devices of "D+E+..." are available, or the backend of that name has any device.
bool is_available(const std::string& name, const std::vector<BackendReport>& backends);

} // namespace tandem
