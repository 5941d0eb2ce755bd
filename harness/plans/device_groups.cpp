// SPDX-License-Identifier: MIT
#include "harness/plans/device_groups.h"

#include "harness/plans/device_models.h"
#include "harness/plans/key.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <iterator>
#include <set>

namespace tandem {

std::vector<std::string> parts_of(const std::string& name) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= name.size();) {
        const auto end = std::min(name.find('+', begin), name.size());
        parts.push_back(name.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

namespace {

/// The reasons why backends have no devices, in brackets; empty when all have some.
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

/// "cuda:0 (NVIDIA H100)" for messages.
std::vector<std::string> models_of(const std::vector<BackendReport>& backends) {
    std::vector<std::string> models;
    for (const auto& backend : backends)
        for (const auto& device : backend.devices)
            models.push_back(fmt::format("{} ({})", device->info().id, model_name(device->info())));
    return models;
}

/// The first device that matches the word. A model matches only devices that are not in the group yet. Throws
/// InputError that names the reason of absence and the available devices.
Device* asked_device(const std::vector<BackendReport>& backends, const std::string& word,
                     const DeviceGroup& group) {
    const bool by_model = asks_for_model(word);
    for (const auto& backend : backends)
        for (const auto& device : backend.devices) {
            const auto& info = device->info();
            if (!by_model && info.id == word) return device.get();
            if (by_model && is_of_model(info, word) && std::ranges::find(group, device.get()) == group.end())
                return device.get();
        }
    if (!by_model) throw InputError(unknown("device", word, ids_of(backends)) + reasons(backends));
    throw InputError(fmt::format("no {}device {}: the backend has no such model; there are: {}{}",
                                 group.empty() ? "" : "other ", word, fmt::join(models_of(backends), ", "),
                                 reasons(backends)));
}

/// "D" or "D+E+..." as a group.
DeviceGroup named_group(const std::vector<BackendReport>& backends, const std::string& name) {
    DeviceGroup group;
    for (const auto& part : parts_of(name)) {
        auto* device = asked_device(backends, part, group);
        if (std::find(group.begin(), group.end(), device) != group.end())
            throw InputError(fmt::format("device {}: {} is named twice; name each device of a cell once",
                                         name, device->info().id));
        group.push_back(device);
    }
    return group;
}

/// Whether every device of "D+E+..." is available.
bool all_available(const std::string& group, const std::vector<BackendReport>& backends) {
    if (group == default_device) return default_of(backends) != nullptr;
    const auto is_known = [&](const std::string& part) {
        return part == "all" || part == each_model || std::ranges::any_of(backends, [&](const auto& backend) {
                   return std::ranges::any_of(backend.devices, [&](const auto& device) {
                       const auto& info = device->info();
                       return info.id == part || is_of_model(info, part)
                              || (asks_for_each(part) && is_among(info, part));
                   });
               });
    };
    return std::ranges::all_of(parts_of(group), is_known);
}

void add_once(std::vector<DeviceGroup>& groups, DeviceGroup group) {
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(std::move(group));
}

/// Adds the first device of each model. Throws InputError when there is none.
void add_each_model(std::vector<DeviceGroup>& chosen, const std::vector<BackendReport>& backends,
                    const std::string& name) {
    std::set<std::string> models;
    for (const auto& backend : backends)
        for (const auto& device : backend.devices)
            if (is_among(device->info(), name) && models.insert(model_of(device->info())).second)
                add_once(chosen, DeviceGroup{device.get()});
    if (models.empty())
        throw InputError(fmt::format("--device {}: there is no device of that backend; there are: {}{}", name,
                                     fmt::join(models_of(backends), ", "), reasons(backends)));
}

/// The first device of a backend that is a GPU, or with `any` the first one; null if there is none.
Device* first_of(const std::vector<BackendReport>& backends, std::string_view name, bool any = false) {
    for (const auto& backend : backends)
        for (const auto& device : backend.devices)
            if (backend.name == name && (any || device->info().is_gpu)) return device.get();
    return nullptr;
}

/// Opens backends until the default device is among them.
void open_default(std::vector<BackendReport>& backends) {
    for (const std::string name : {"cuda", "opencl", "host"}) {
        if (std::ranges::find(backends, name, &BackendReport::name) == backends.end())
            std::ranges::move(discover({&name, 1}), std::back_inserter(backends));
        if (first_of(backends, name) != nullptr) return;
    }
}

} // namespace

Device* default_of(const std::vector<BackendReport>& backends) {
    for (const auto* name : {"cuda", "opencl"})
        if (auto* gpu = first_of(backends, name); gpu != nullptr) return gpu;
    return first_of(backends, "host", true);
}

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
    if (std::ranges::find(names, default_device) != names.end()) open_default(backends);
    const bool known =
        std::ranges::all_of(names, [&](const auto& name) { return all_available(name, backends); })
        && std::ranges::all_of(require, [&](const auto& name) { return is_available(name, backends); });
    return known ? std::move(backends)
                 : add_missing_backends(std::move(backends)); // the error message lists all
}

std::vector<DeviceGroup> choose_devices(const std::vector<BackendReport>& backends,
                                        std::span<const std::string> names) {
    std::vector<DeviceGroup> chosen;
    for (const auto& name : names) {
        if (name == "all") {
            for (const auto& backend : backends)
                for (const auto& device : backend.devices) add_once(chosen, DeviceGroup{device.get()});
        } else if (asks_for_each(name)) {
            add_each_model(chosen, backends, name);
        } else if (name == default_device) {
            add_once(chosen, DeviceGroup{default_of(backends)});
        } else {
            add_once(chosen, named_group(backends, name));
        }
    }
    return chosen;
}

bool is_available(const std::string& name, const std::vector<BackendReport>& backends) {
    const auto is_backend = [&](const auto& backend) {
        return backend.name == name && !backend.devices.empty();
    };
    return std::ranges::any_of(backends, is_backend) || all_available(name, backends);
}

} // namespace tandem
