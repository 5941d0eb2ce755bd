// SPDX-License-Identifier: MIT
#include "harness/profile/output.h"

#include <nlohmann/json.hpp>

namespace tandem::profile {

namespace {

using Json = nlohmann::ordered_json;

constexpr int schema = 2; ///< version of results/profile.schema.json

Json known(const std::optional<double>& value) { return value ? Json(*value) : Json(); }
Json known(std::int64_t value) { return value < 0 ? Json() : Json(value); }
Json positive(double value) { return value > 0 ? Json(value) : Json(); }

Json floor_json(const KernelProfile& kernel) {
    return {{"ns", known(kernel.floor.ns())},
            {"bytes_ns", known(kernel.floor.bytes)},
            {"cached", kernel.floor.cached},
            {"operations_ns", known(kernel.floor.operations)},
            {"launches_ns", known(kernel.floor.launches)}};
}

Json kernel_json(const KernelProfile& kernel) {
    const auto& facts = kernel.sample.facts;
    const auto bound = kernel.bound();
    return {{"entry", kernel.entry},
            {"stage", stage_names[static_cast<std::size_t>(kernel.sample.stage)]},
            {"device_ns",
             {{"median", kernel.ns.median},
              {"q1", kernel.ns.q1},
              {"q3", kernel.ns.q3},
              {"low", kernel.ns.low},
              {"high", kernel.ns.high}}},
            {"share", kernel.time_fraction},
            {"launches", kernel.launches},
            {"groups", kernel.sample.groups},
            {"group_size", kernel.sample.group_size},
            {"registers", known(facts.registers)},
            {"local_bytes", known(facts.local_bytes)},
            {"spill_bytes", known(facts.spill_bytes)},
            {"stack_bytes", known(facts.stack_bytes)},
            {"occupancy", facts.occupancy < 0 ? Json() : Json(facts.occupancy)},
            {"defines", facts.defines},
            {"bytes", known(kernel.bytes)},
            {"operations", known(kernel.operations)},
            {"counted", kernel.how.empty() ? Json() : Json(kernel.how)},
            {"bytes_per_s", known(kernel.bytes_per_s())},
            {"operations_per_s", known(kernel.operations_per_s())},
            {"of_bytes", known(kernel.of_bytes())},
            {"of_operations", known(kernel.of_operations())},
            {"floor", floor_json(kernel)},
            {"over_floor", known(kernel.over_floor())},
            {"bound", bound ? Json(*bound) : Json()},
            {"counters", nullptr}};
}

Json facts_json(const FrameFacts& facts) {
    Json work = Json::object();
    for (const auto& [counter, count] : facts.work) work[std::string(counter)] = count;
    return {{"body_pairs", facts.body_pairs},
            {"candidate_pairs", facts.candidate_pairs},
            {"contacts", facts.contacts},
            {"touched_tetrahedra", facts.touched},
            {"touched_rows", facts.touched_rows},
            {"touched_vertices", facts.touched_vertices},
            {"counters", work}};
}

Json limits_json(const Profile& profile) {
    const auto& l = profile.limits;
    return {
        {"from", profile.ceilings_from},          {"date", profile.ceilings->at("environment").at("date")},
        {"bytes_per_s", positive(l.bytes_per_s)}, {"cached_bytes_per_s", positive(l.cached_bytes_per_s)},
        {"cached_bytes", l.cached_bytes},         {"operations_per_s", positive(l.operations_per_s)},
        {"launch_s", positive(l.launch_s)}};
}

} // namespace

/// The key field is named "profile_of", so that `tandem compare` and --resume do not read it as a record of a
/// cell.
Json profile_record(const Json& record, const Profile& profile) {
    Json json{{"schema", schema}, {"profile_of", record.at("key")}};
    for (const char* name :
         {"session", "command", "status", "failure", "algorithm", "preset", "settings", "scene", "frames",
          "devices", "sampling", "conditions", "total_ns", "breakdown_ns", "agreement"})
        json[name] = record.at(name);
    json["ceilings"] = limits_json(profile);
    json["frame"] = facts_json(profile.facts);
    json["kernels"] = Json::array();
    for (const auto& kernel : profile.kernels) json["kernels"].push_back(kernel_json(kernel));
    json["counters"] = nullptr;
    json["environment"] = record.at("environment");
    return json;
}

} // namespace tandem::profile
