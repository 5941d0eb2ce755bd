// SPDX-License-Identifier: MIT
#include "harness/profile/limits.h"

#include "harness/profile/ceilings.h"
#include "harness/record/record.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

namespace tandem::profile {

namespace {

/// The median of a field; 0 when it is null or missing.
double median_at(const nlohmann::ordered_json& ceilings, const char* name) {
    const auto found = ceilings.find(name);
    return found == ceilings.end() || found->is_null() ? 0 : found->at("median").get<double>();
}

/// The fastest sample of a field, for a floor; 0 as above.
double least_at(const nlohmann::ordered_json& ceilings, const char* name) {
    const auto found = ceilings.find(name);
    if (found == ceilings.end() || found->is_null()) return 0;
    const auto samples = found->at("samples").get<std::vector<double>>();
    return samples.empty() ? 0 : *std::ranges::min_element(samples);
}

bool is_of(const nlohmann::ordered_json& ceilings, const nlohmann::ordered_json& device) {
    const auto found = ceilings.find("device");
    if (found == ceilings.end()) return false;
    // The same hardware has different ceilings through different backends.
    const auto backend = [](const nlohmann::ordered_json& json) {
        const auto id = json.at("id").get<std::string>();
        return id.substr(0, id.find(':'));
    };
    const char* which = device.at("hardware").is_null() ? "name" : "hardware";
    return backend(*found) == backend(device) && found->at(which) == device.at(which);
}

} // namespace

Limits limits_of(const nlohmann::ordered_json& ceilings, int k) {
    Limits limits;
    limits.bytes_per_s =
        std::max(median_at(ceilings, "copy_bytes_per_s"), median_at(ceilings, "read_bytes_per_s"));
    limits.cached_bytes_per_s = median_at(ceilings, "cache_read_bytes_per_s");
    DeviceInfo info;
    info.is_gpu = ceilings.at("device").at("kind") == "gpu";
    limits.cached_bytes = static_cast<double>(cached_bytes(info));
    const auto few = 8 * median_at(ceilings, "overlap_tests_k8_per_s");
    const auto many = 18 * median_at(ceilings, "overlap_tests_k18_per_s");
    const auto fraction = std::clamp((k - 8) / 10.0, 0.0, 1.0);
    limits.operations_per_s = few > 0 && many > 0 ? few + fraction * (many - few) : 0;
    const auto timed = least_at(ceilings, "launch_timed_s");
    limits.launch_s = timed > 0 ? timed : least_at(ceilings, "launch_queued_s");
    return limits;
}

nlohmann::ordered_json read_ceilings(const std::string& path, const DeviceInfo& info) {
    std::ifstream in(path);
    if (!in) throw InputError(fmt::format("{}: cannot be read; name a file of ceilings", path));
    const auto device = record_device(info);
    nlohmann::ordered_json last;
    std::size_t number = 0;
    for (std::string line; std::getline(in, line);) {
        ++number;
        try {
            auto record = nlohmann::ordered_json::parse(line);
            if (!is_of(record, device)) continue;
            limits_of(record, 18);
            last = std::move(record);
        } catch (const nlohmann::json::exception&) {
            throw InputError(fmt::format(
                "{}:{}: is no record of ceilings; give a file that 'tandem devices --measure --out' wrote",
                path, number));
        }
    }
    if (last.is_null())
        throw InputError(fmt::format("{}: no ceilings of {} ({}); leave --ceilings out to measure them", path,
                                     info.id, info.name));
    return last;
}

void check_clock(const std::string& path, const nlohmann::ordered_json& ceilings, Device& device) {
    if (median_at(ceilings, "launch_timed_s") == 0) return;
    device.set_clocks(Clocks::on); // device.clock() is known only after this
    device.set_clocks(Clocks::off);
    const auto recorded = ceilings.at("device").value("clock", "an unknown clock");
    const auto kind = [](const std::string& clock) { return clock.substr(0, clock.find(' ')); };
    if (kind(recorded) != kind(device.clock()))
        throw InputError(
            fmt::format("{}: launches on {} were timed by {}, but kernels are timed by {}; leave "
                        "--ceilings out to measure them",
                        path, device.info().id, recorded, device.clock()));
}

} // namespace tandem::profile
