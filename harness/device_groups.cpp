// SPDX-License-Identifier: MIT
#include "harness/device_groups.h"

#include "scenes/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Why backends have no devices, in brackets; empty when all have some.
std::string reasons(const std::vector<BackendReport>& backends) {
    std::string text;
    for (const auto& backend : backends)
        if (!backend.reason.empty()) text += (text.empty() ? "" : "; ") + backend.reason;
    return text.empty() ? "" : fmt::format(" ({})", text);
}

/// The device of that id; throws InputError that names the reason of absence and what there is.
Device* named_device(const std::vector<BackendReport>& backends, const std::string& name) {
    std::vector<std::string> ids;
    for (const auto& backend : backends)
        for (const auto& device : backend.devices) {
            if (device->info().id == name) return device.get();
            ids.push_back(device->info().id);
        }
    throw InputError(unknown("device", name, ids) + reasons(backends));
}

/// "D" or "D+E+..." as a group.
DeviceGroup named_group(const std::vector<BackendReport>& backends, const std::string& name) {
    DeviceGroup group;
    std::size_t begin = 0;
    for (auto end = name.find('+'); begin <= name.size(); begin = end + 1, end = name.find('+', begin)) {
        end = std::min(end, name.size());
        auto* device = named_device(backends, name.substr(begin, end - begin));
        if (std::find(group.begin(), group.end(), device) != group.end())
            throw InputError(fmt::format("device {}: {} is named twice; a device works for a cell once", name,
                                         device->info().id));
        group.push_back(device);
    }
    return group;
}

void add_once(std::vector<DeviceGroup>& groups, DeviceGroup group) {
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(std::move(group));
}

} // namespace

std::string name_of(const DeviceGroup& devices) {
    std::string name;
    for (const auto* device : devices) name += (name.empty() ? "" : "+") + device->info().id;
    return name;
}

std::vector<DeviceGroup> choose_devices(const std::vector<BackendReport>& backends,
                                        std::span<const std::string> names) {
    std::vector<DeviceGroup> chosen;
    for (const auto& name : names) {
        if (name != "all") {
            add_once(chosen, named_group(backends, name));
            continue;
        }
        for (const auto& backend : backends)
            for (const auto& device : backend.devices) add_once(chosen, DeviceGroup{device.get()});
    }
    return chosen;
}

} // namespace tandem
