// SPDX-License-Identifier: MIT
#include "harness/isolation/described.h"

#include "backends/described_device.h"
#include "harness/device_models.h"
#include "harness/fields_json.h"
#include "harness/isolation/isolated_sampler.h"

namespace tandem {

TANDEM_FIELDS(DeviceInfo, id, name, driver, compiler, processor, hardware, is_gpu, compute_units,
              max_group_size, cores, clock_mhz, peak_bytes_per_s, global_bytes, max_allocation, local_bytes,
              allocates_late, has_double, has_directed_rounding, stages_pinned)

nlohmann::json device_json(const DeviceInfo& info) {
    auto described = info;
    if (info.id == "host") described.processor = model_name(info);
    return described;
}

DeviceInfo device_of(const nlohmann::json& from) { return from.get<DeviceInfo>(); }

nlohmann::json backends_json(const std::vector<BackendReport>& backends) {
    auto all = nlohmann::json::array();
    for (const auto& backend : backends) {
        auto devices = nlohmann::json::array();
        for (const auto& device : backend.devices) devices.push_back(device_json(device->info()));
        all.push_back({{"name", backend.name}, {"reason", backend.reason}, {"devices", devices}});
    }
    return all;
}

std::vector<BackendReport> backends_of(const nlohmann::json& from) {
    std::vector<BackendReport> all;
    for (const auto& backend : from) {
        auto& report = all.emplace_back();
        backend.at("name").get_to(report.name);
        backend.at("reason").get_to(report.reason);
        for (const auto& device : backend.at("devices"))
            report.devices.push_back(described_device(device_of(device)));
    }
    return all;
}

nlohmann::json describe_backends(std::span<const std::string> names) {
    const std::vector<std::string> asked(names.begin(), names.end());
    return AnsweringProcess().ask({{"work", "describe"}, {"devices", asked}}, {}).at("backends");
}

} // namespace tandem
