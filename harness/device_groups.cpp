// SPDX-License-Identifier: MIT
#include "harness/device_groups.h"

#include "scenes/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <sstream>

namespace tandem {

namespace {

/// Why backends have no devices, in brackets; empty when all have some.
std::string reasons(const std::vector<BackendReport>& backends) {
    std::string text;
    for (const auto& backend : backends)
        if (!backend.reason.empty()) text += (text.empty() ? "" : "; ") + backend.reason;
    return text.empty() ? "" : fmt::format(" ({})", text);
}

std::vector<std::string> ids_of(const std::vector<BackendReport>& backends) {
    std::vector<std::string> ids;
    for (const auto& backend : backends)
        for (const auto& device : backend.devices) ids.push_back(device->info().id);
    return ids;
}

/// The device of that id; throws InputError that names the reason of absence and what there is.
Device* named_device(const std::vector<BackendReport>& backends, const std::string& name) {
    for (const auto& backend : backends)
        for (const auto& device : backend.devices)
            if (device->info().id == name) return device.get();
    throw InputError(unknown("device", name, ids_of(backends)) + reasons(backends));
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

/// Whether every device of "D+E+..." is there.
bool all_there(const std::string& group, std::span<const std::string> ids) {
    if (group.empty() || group.ends_with('+')) return false;
    std::istringstream parts(group);
    for (std::string part; std::getline(parts, part, '+');)
        if (part != "all" && std::ranges::find(ids, part) == ids.end()) return false;
    return true;
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

std::vector<BackendReport> open_backends(std::span<const std::string> names,
                                         std::span<const std::string> require) {
    std::vector<std::string> wanted(names.begin(), names.end());
    wanted.insert(wanted.end(), require.begin(), require.end());
    auto backends = discover(wanted);
    const auto ids = ids_of(backends);
    const auto is_backend = [&](const std::string& name) {
        return std::ranges::any_of(backends,
                                   [&](const auto& b) { return b.name == name && !b.devices.empty(); });
    };
    const bool known = std::ranges::all_of(names, [&](const auto& name) { return all_there(name, ids); })
                       && std::ranges::all_of(require, [&](const auto& name) {
                              return is_backend(name) || all_there(name, ids);
                          });
    return known ? std::move(backends) : discover();
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
