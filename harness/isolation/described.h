// SPDX-License-Identifier: MIT
#pragma once

#include "backends/registry.h"

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace tandem {

nlohmann::json device_json(const DeviceInfo& info);
/// The same back. Throws nlohmann::json::exception when it is none.
DeviceInfo device_of(const nlohmann::json& json);

/// Back ends and what their devices are, and back again with devices that are described.
nlohmann::json backends_json(const std::vector<BackendReport>& backends);
std::vector<BackendReport> backends_of(const nlohmann::json& json);

/// What open_backends(names) of a process of its own finds, as backends_json(): no driver is loaded into this
/// one, and none of them can end it. Throws DeviceError where that process fails.
nlohmann::json describe_backends(std::span<const std::string> names);

} // namespace tandem
