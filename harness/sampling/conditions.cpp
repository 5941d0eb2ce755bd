// SPDX-License-Identifier: MIT
#include "harness/sampling/conditions.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <utility>

namespace tandem {

namespace {

/// Rounds to thousandths, which is precise enough and keeps records short.
nlohmann::ordered_json number_or_null(std::optional<double> value) {
    if (!value || !std::isfinite(*value)) return nullptr;
    return std::round(*value * 1000) / 1000;
}

template<class Value>
nlohmann::ordered_json value_or_null(const std::optional<Value>& value) {
    if (!value) return nullptr;
    return *value;
}

void add_reason(std::string& reasons, const std::string& reason) {
    reasons += (reasons.empty() ? "" : "; ") + reason;
}

void add_processor(std::string& reasons, const ProcessorCondition& after, const Thresholds& thresholds) {
    if (after.other_processes && *after.other_processes > thresholds.other_processes * after.cores)
        add_reason(reasons, fmt::format("busy: other processes use {:.1f} of {} cores",
                                        *after.other_processes, after.cores));
    if (after.throttled && *after.throttled > thresholds.throttled)
        add_reason(reasons, *after.throttled == 1
                                ? "quota: throttled once"
                                : fmt::format("quota: throttled {} times", *after.throttled));
}

/// `where` names the device when there are several.
void add_gpu(std::string& reasons, const GpuCondition& before, const GpuCondition& after,
             const Thresholds& thresholds, const std::string& where) {
    const auto slowed = throttle_reasons(before.throttle.value_or(0) | after.throttle.value_or(0));
    if (!slowed.empty()) add_reason(reasons, fmt::format("throttled{}: {}", where, fmt::join(slowed, ", ")));
    const auto processes = std::max(before.processes.value_or(0), after.processes.value_or(0));
    if (processes > thresholds.processes)
        add_reason(reasons, fmt::format("other processes on the GPU{}: {}", where, processes));
}

nlohmann::ordered_json processor_json(const ProcessorCondition& p) {
    return {{"cores", p.cores == 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(p.cores)},
            {"quota_cores", number_or_null(p.quota)},
            {"own_cores", number_or_null(p.own)},
            {"other_cores", number_or_null(p.other_processes)},
            {"governor", value_or_null(p.governor)},
            {"mhz", number_or_null(p.mhz)},
            {"throttled_periods", value_or_null(p.throttled)},
            {"pressure_percent", number_or_null(p.pressure)}};
}

} // namespace

ConditionReader::ConditionReader(const DeviceGroup& devices, std::string root, std::function<OwnUse()> own)
    : processor_(std::move(root), std::move(own)) {
    for (const auto* device : devices) gauges_.emplace_back(device->info());
}

Condition ConditionReader::read() {
    Condition condition{.processor = processor_.read(), .gpus = {}};
    for (const auto& gauge : gauges_) condition.gpus.push_back(gauge.read());
    return condition;
}

std::optional<std::string> disturbance(const Condition& before, const Condition& after,
                                       const Thresholds& thresholds) {
    std::string reasons;
    add_processor(reasons, after.processor, thresholds);
    const auto devices = std::min(before.gpus.size(), after.gpus.size());
    for (std::size_t i = 0; i < devices; ++i)
        add_gpu(reasons, before.gpus[i], after.gpus[i], thresholds,
                devices == 1 ? "" : fmt::format(" (device {} of {})", i + 1, devices));
    if (reasons.empty()) return std::nullopt;
    return reasons;
}

nlohmann::ordered_json gpu_condition_json(const GpuCondition& g) {
    if (g == GpuCondition{}) return nullptr;
    nlohmann::ordered_json throttle;
    if (g.throttle) throttle = throttle_reasons(*g.throttle);
    return {{"sm_mhz", value_or_null(g.sm_mhz)},
            {"sm_limit_mhz", value_or_null(g.sm_limit_mhz)},
            {"memory_mhz", value_or_null(g.memory_mhz)},
            {"memory_limit_mhz", value_or_null(g.memory_limit_mhz)},
            {"temperature_c", value_or_null(g.temperature_c)},
            {"power_w", number_or_null(g.power_w)},
            {"power_limit_w", number_or_null(g.power_limit_w)},
            {"throttle_bits", value_or_null(g.throttle)},
            {"throttled", throttle},
            {"busy_percent", value_or_null(g.busy_percent)},
            {"other_processes", value_or_null(g.processes)}};
}

nlohmann::ordered_json condition_json(const Condition& condition) {
    auto gpus = nlohmann::ordered_json::array();
    for (const auto& gpu : condition.gpus) gpus.push_back(gpu_condition_json(gpu));
    return {{"processor", processor_json(condition.processor)}, {"gpus", gpus}};
}

namespace {

/// Joins the reasons of throttling into one text, empty without reasons, so that all readings have one shape.
nlohmann::ordered_json with_reasons_as_text(nlohmann::ordered_json condition) {
    for (auto& gpu : condition["gpus"])
        if (!gpu.is_null() && gpu["throttled"].is_array())
            gpu["throttled"] =
                fmt::to_string(fmt::join(gpu["throttled"].get<std::vector<std::string>>(), ", "));
    return condition;
}

/// Merges values of one shape, or null, into one value.
nlohmann::ordered_json folded(const std::vector<nlohmann::ordered_json>& values) {
    const auto shape = std::ranges::find_if(values, [](const auto& value) { return value.is_structured(); });
    if (shape == values.end()) {
        const bool is_same = std::ranges::all_of(values, [&](const auto& v) { return v == values.front(); });
        return is_same ? values.front() : nlohmann::ordered_json(values);
    }
    auto result = *shape;
    for (const auto& [name, part] : shape->items()) {
        std::vector<nlohmann::ordered_json> parts;
        parts.reserve(values.size());
        for (const auto& value : values)
            parts.push_back(value.is_null()     ? nlohmann::ordered_json()
                            : shape->is_array() ? value.at(std::stoul(name))
                                                : value.at(name));
        (shape->is_array() ? result.at(std::stoul(name)) : result.at(name)) = folded(parts);
    }
    return result;
}

} // namespace

nlohmann::ordered_json conditions_json(std::span<const Condition> conditions) {
    std::vector<nlohmann::ordered_json> readings;
    for (const auto& condition : conditions)
        readings.push_back(with_reasons_as_text(condition_json(condition)));
    return folded(readings);
}

std::string gpu_condition_text(const GpuCondition& g) {
    std::vector<std::string> parts;
    if (g.sm_mhz) parts.push_back(fmt::format("{} MHz SM", *g.sm_mhz));
    if (g.memory_mhz) parts.push_back(fmt::format("{} MHz memory", *g.memory_mhz));
    if (g.temperature_c) parts.push_back(fmt::format("{} C", *g.temperature_c));
    if (g.power_w)
        parts.push_back(g.power_limit_w ? fmt::format("{:.0f} of {:.0f} W", *g.power_w, *g.power_limit_w)
                                        : fmt::format("{:.0f} W", *g.power_w));
    const auto slowed = throttle_reasons(g.throttle.value_or(0));
    if (!slowed.empty()) parts.push_back(fmt::format("throttled: {}", fmt::join(slowed, ", ")));
    return fmt::format("{}", fmt::join(parts, ", "));
}

} // namespace tandem
