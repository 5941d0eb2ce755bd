// SPDX-License-Identifier: MIT
// The fields of conditions in records.
#include "harness/fields/types.h"
#include "harness/sampling/conditions.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem::record_parts {

namespace {

Type one_or_each(const char* name, const char* meaning, const Type& type) {
    const auto element = type.with("description", "one").schema;
    return definition(
        name,
        {.schema = {{"description", meaning},
                    {"anyOf", {type.schema, {{"type", "array"}, {"minItems", 2}, {"items", element}}}}}});
}

Type numbers() {
    return one_or_each("numbers",
                       "a number, null when not told; an array of them, one a round, where they differ",
                       nullable(number_from(0)));
}

Type texts() {
    return one_or_each("texts",
                       "a text, null when not told; an array of them, one a round, where they differ",
                       nullable(any_text()));
}

/// Rounds to thousandths, which is precise enough and keeps records short.
Json rounded(std::optional<double> value) {
    if (!value || !std::isfinite(*value)) return nullptr;
    return std::round(*value * 1000) / 1000;
}

const Fields<ProcessorCondition>& processor_fields() {
    static const Fields<ProcessorCondition> fields{
        {"cores", numbers(), "that the program may run on; 0 when unknown",
         [](auto& p) { return p.cores == 0 ? Json() : Json(p.cores); }},
        {"quota_cores", numbers(), "cores that its control group leaves it; null without a limit",
         [](auto& p) { return rounded(p.quota); }},
        {"own_cores", numbers(),
         "of these cores, busy with the program, a mean over a quarter of a second or more",
         [](auto& p) { return rounded(p.own); }},
        {"other_cores", numbers(), "busy with anything else",
         [](auto& p) { return rounded(p.other_processes); }},
        {"governor", texts(), "of the clocks; mixed where cores differ", &ProcessorCondition::governor},
        {"mhz", numbers(), "mean clock", [](auto& p) { return rounded(p.mhz); }},
        {"throttled_periods", numbers(), "since the reading before, in which the quota was used up",
         &ProcessorCondition::throttled},
        {"pressure_percent", numbers(), "of the last ten seconds, in which a task waited for a core",
         [](auto& p) { return rounded(p.pressure); }}};
    return fields;
}

Json reasons_json(const GpuCondition& g) { return g.throttle ? Json(throttle_reasons(*g.throttle)) : Json(); }

const Fields<GpuCondition>& gpu_fields() {
    static const Fields<GpuCondition> fields{
        {"sm_mhz", numbers(), "clock of the multiprocessors", &GpuCondition::sm_mhz},
        {"sm_limit_mhz", numbers(), "the highest that they have", &GpuCondition::sm_limit_mhz},
        {"memory_mhz", numbers(), "clock of the memory", &GpuCondition::memory_mhz},
        {"memory_limit_mhz", numbers(), "the highest that it has", &GpuCondition::memory_limit_mhz},
        {"temperature_c", numbers(), "degrees Celsius", &GpuCondition::temperature_c},
        {"power_w", numbers(), "drawn", [](auto& g) { return rounded(g.power_w); }},
        {"power_limit_w", numbers(), "enforced", [](auto& g) { return rounded(g.power_limit_w); }},
        {"throttle_bits", numbers(), "NVML's reasons for clocks that are not higher",
         &GpuCondition::throttle},
        {"throttled", texts(), "those of them that slow it down against anyone's wish", reasons_json},
        {"busy_percent", numbers(), "of the driver's last period in which kernels ran",
         &GpuCondition::busy_percent},
        {"other_processes", numbers(), "that compute on it", &GpuCondition::processes}};
    return fields;
}

const Fields<Condition>& condition_fields() {
    static const Fields<Condition> fields{
        {"processor", processor_fields().type("the host's"), "",
         [](auto& c) { return processor_fields().write(c.processor); }},
        {"gpus", array_of(nullable(gpu_fields().type("a GPU, as NVML tells"))),
         "one for each device of the cell; null of processors and where NVML is not", [](auto& c) {
             Json gpus = Json::array();
             for (const auto& gpu : c.gpus) gpus.push_back(gpu_condition_json(gpu));
             return gpus;
         }}};
    return fields;
}

/// Joins the reasons of throttling into one text, empty without reasons, so that all readings have one shape.
Json with_reasons_as_text(Json condition) {
    for (auto& gpu : condition["gpus"])
        if (!gpu.is_null() && gpu["throttled"].is_array())
            gpu["throttled"] =
                fmt::to_string(fmt::join(gpu["throttled"].get<std::vector<std::string>>(), ", "));
    return condition;
}

/// Merges values of one shape, or null, into one value.
Json folded(const std::vector<Json>& values) {
    const auto shape = std::ranges::find_if(values, [](const auto& value) { return value.is_structured(); });
    if (shape == values.end()) {
        const bool is_same = std::ranges::all_of(values, [&](const auto& v) { return v == values.front(); });
        return is_same ? values.front() : Json(values);
    }
    auto result = *shape;
    for (const auto& [name, part] : shape->items()) {
        std::vector<Json> parts;
        parts.reserve(values.size());
        for (const auto& value : values)
            parts.push_back(value.is_null()     ? Json()
                            : shape->is_array() ? value.at(std::stoul(name))
                                                : value.at(name));
        (shape->is_array() ? result.at(std::stoul(name)) : result.at(name)) = folded(parts);
    }
    return result;
}

} // namespace

Type condition_type() {
    return definition("condition", condition_fields().type("what the machine was like"));
}

} // namespace tandem::record_parts

namespace tandem {

nlohmann::ordered_json gpu_condition_json(const GpuCondition& condition) {
    if (condition == GpuCondition{}) return nullptr;
    return record_parts::gpu_fields().write(condition);
}

nlohmann::ordered_json condition_json(const Condition& condition) {
    return record_parts::condition_fields().write(condition);
}

nlohmann::ordered_json conditions_json(std::span<const Condition> conditions) {
    std::vector<nlohmann::ordered_json> readings;
    for (const auto& condition : conditions)
        readings.push_back(record_parts::with_reasons_as_text(condition_json(condition)));
    return record_parts::folded(readings);
}

} // namespace tandem
