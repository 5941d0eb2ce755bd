// SPDX-License-Identifier: MIT
#include "harness/sampling/conditions.h"

#include "harness/sampling/turns.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <utility>

namespace tandem {

namespace {

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

} // namespace

ConditionReader::ConditionReader(const DeviceGroup& devices, std::string root, std::function<OwnUse()> own)
    : processor_(std::move(root), std::move(own)), takes_turns_(Turns::are_taken()) {
    for (const auto* device : devices) gauges_.emplace_back(device->info());
}

Condition ConditionReader::read() {
    Condition condition{.processor = processor_.read(), .gpus = {}};
    for (const auto& gauge : gauges_) {
        auto gpu = gauge.read();
        if (takes_turns_ && gpu.processes.value_or(0) > 0) --*gpu.processes;
        condition.gpus.push_back(gpu);
    }
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
