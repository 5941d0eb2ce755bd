// SPDX-License-Identifier: MIT
#include "harness/report/records.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>

namespace tandem::report {

namespace {

using Record = nlohmann::json;

/// Least and greatest of a number, or of an array of them with nulls where nothing was read.
void widen(std::optional<std::pair<double, double>>& range, const Record& value) {
    if (value.is_array())
        for (const auto& one : value) widen(range, one);
    if (!value.is_number()) return;
    const auto number = value.get<double>();
    if (!range) range = {number, number};
    range = {std::min(range->first, number), std::max(range->second, number)};
}

/// "1980 MHz" or "41 to 52 °C", of the readings before and after the rounds; empty where nothing was read.
std::string range_of(const Record& before, const Record& after, const char* field, std::string_view unit) {
    std::optional<std::pair<double, double>> range;
    for (const auto* reading : {&before, &after})
        if (reading->is_object() && reading->contains(field)) widen(range, reading->at(field));
    if (!range) return {};
    const auto low = fmt::format("{:.4g}", range->first);
    const auto high = fmt::format("{:.4g}", range->second);
    return fmt::format("{}{}{}", low, low == high ? "" : " to " + high, unit);
}

void add(std::vector<std::string>& parts, const std::string& what, const std::string& range) {
    if (!range.empty()) parts.push_back(what + range);
}

void add_gpu(std::vector<std::string>& parts, const Record& before, const Record& after) {
    add(parts, "GPU at ", range_of(before, after, "sm_mhz", " MHz"));
    add(parts, "", range_of(before, after, "temperature_c", " °C"));
    add(parts, "", range_of(before, after, "power_w", " W"));
    const auto others = range_of(before, after, "other_processes", "");
    if (!others.empty() && others != "0") parts.push_back("other processes on it: " + others);
}

} // namespace

std::string conditions_text(const Record& record) {
    const auto conditions = record.value("conditions", Record());
    if (!conditions.is_object()) return "not recorded";
    const auto& before = conditions.at("before");
    const auto& after = conditions.at("after");
    std::vector<std::string> parts;
    const auto& gpus = before.at("gpus");
    for (std::size_t i = 0; i < gpus.size() && i < after.at("gpus").size(); ++i)
        add_gpu(parts, gpus[i], after.at("gpus")[i]);
    add(parts, "processor at ", range_of(before.at("processor"), after.at("processor"), "mhz", " MHz"));
    add(parts, "cores busy with others: ",
        range_of(before.at("processor"), after.at("processor"), "other_cores", ""));
    const auto& disturbed = conditions.at("disturbed");
    if (!disturbed.empty())
        parts.push_back(fmt::format("{} doubtful {}, the first: {}", disturbed.size(),
                                    disturbed.size() == 1 ? "round" : "rounds",
                                    disturbed[0].at("why").get<std::string>()));
    return fmt::format("{}", fmt::join(parts, ", "));
}

std::string sampling_text(const Record& record) {
    const auto sampling = record.value("sampling", Record());
    if (!sampling.is_object()) return "not recorded";
    std::vector<std::string> parts;
    const auto is = [&](const char* field) { return sampling.value(field, Record()) == true; };
    if (sampling.value("converged", Record()) == false)
        parts.push_back("its interval stayed wider than asked for");
    if (is("interrupted")) parts.push_back("interrupted before it was sampled enough");
    if (const auto outliers = sampling.value("outliers", Record()); outliers.is_number() && outliers != 0)
        parts.push_back(fmt::format("outliers: {}", outliers.dump()));
    if (const auto drift = sampling.value("drift", Record()); drift.is_number())
        parts.push_back(fmt::format("drifted by {:.2g} %", 100 * drift.get<double>()));
    return parts.empty() ? "nothing speaks against it" : fmt::format("{}", fmt::join(parts, ", "));
}

} // namespace tandem::report
