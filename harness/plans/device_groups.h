// SPDX-License-Identifier: MIT
#pragma once

#include "backends/registry.h"

#include <span>
#include <string>
#include <vector>

namespace tandem {

/// Stands for the device of a command that names none: the first GPU, CUDA's before OpenCL's, because both
/// may show the same card; `host` where there is no GPU.
inline constexpr const char* default_device = "default";
inline constexpr const char* default_device_help = "the first GPU, else host";

/// The devices of one cell, which split its work: one, or several named D+E.
using DeviceGroup = std::vector<Device*>;

/// The names in "D+E", without the pluses.
std::vector<std::string> parts_of(const std::string& name);

/// The name of the group, "host" or "host+opencl:0".
std::string name_of(const DeviceGroup& devices);

/// Opens the backends of the named and the required devices. No other backend is opened, so that it can
/// neither break nor delay the command; for the default device, backends are opened until one has a GPU. When
/// a name is unknown, all backends are opened for the error message.
std::vector<BackendReport> open_backends(std::span<const std::string> names,
                                         std::span<const std::string> require);

/// The device that `default_device` stands for, among all backends that it may be of; null if these lack it.
Device* default_of(const std::vector<BackendReport>& backends);

/// The devices of the names, in order: by number, by model or one of each model (see device_models.h), "all",
/// or the default. Throws InputError that names the reason of absence and the available devices.
std::vector<DeviceGroup> choose_devices(const std::vector<BackendReport>& backends,
                                        std::span<const std::string> names);

/// Whether all devices of "D+E+..." are available, or the backend of that name has any device.
bool is_available(const std::string& name, const std::vector<BackendReport>& backends);

} // namespace tandem
