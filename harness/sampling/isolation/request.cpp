// SPDX-License-Identifier: MIT
#include "harness/sampling/isolation/request.h"

#include <nlohmann/json.hpp>

namespace tandem {

namespace {

/// The options that select the scene, its frames and the check.
nlohmann::json options_json(const RunOptions& options) {
    return {
        {"scene", options.scene},
        {"meshes", options.meshes},
        {"poses", options.poses},
        {"frames", options.frames},
        {"degenerate", static_cast<int>(options.degenerate)},
        {"duplicates", static_cast<int>(options.reading.duplicates)},
        {"weld", options.reading.weld ? nlohmann::json(*options.reading.weld) : nlohmann::json()},
        {"pressure", options.reading.pressure ? nlohmann::json(*options.reading.pressure) : nlohmann::json()},
        {"corners", options.reading.corners},
        {"only_tetrahedra", options.reading.only_tetrahedra},
        {"memory", options.memory},
        {"truth", static_cast<int>(options.truth)},
        {"truth_contacts", options.truth_contacts},
        {"check_afresh", options.check_afresh}};
}

void read_options(RunOptions& options, const nlohmann::json& json) {
    json.at("scene").get_to(options.scene);
    json.at("meshes").get_to(options.meshes);
    json.at("poses").get_to(options.poses);
    json.at("frames").get_to(options.frames);
    options.degenerate = static_cast<Degenerate>(json.at("degenerate").get<int>());
    options.reading.duplicates = static_cast<Duplicates>(json.at("duplicates").get<int>());
    if (!json.at("weld").is_null()) options.reading.weld = json.at("weld").get<double>();
    if (!json.at("pressure").is_null()) options.reading.pressure = json.at("pressure").get<double>();
    json.at("corners").get_to(options.reading.corners);
    json.at("only_tetrahedra").get_to(options.reading.only_tetrahedra);
    json.at("memory").get_to(options.memory);
    options.truth = static_cast<TruthAmount>(json.at("truth").get<int>());
    json.at("truth_contacts").get_to(options.truth_contacts);
    json.at("check_afresh").get_to(options.check_afresh);
}

} // namespace

nlohmann::json request_json(const RunOptions& options, const CellSampler& sampler, const IsolatedWork& work) {
    const auto& cell = sampler.cell();
    const auto& state = sampler.state();
    auto request = options_json(options);
    request.update(
        {{"algorithm", cell.algorithm->name()},
         {"preset", cell.preset},
         {"settings", cell.settings.texts()},
         {"devices", name_of(cell.devices)},
         {"work", work.work},
         {"samples", work.samples},
         {"check", work.check.check},
         {"count", work.check.count_work},
         {"checked", state.is_checked() ? checked_json(state) : nlohmann::ordered_json()},
         {"rounds", rounds_json(state, state.rounds)}}); // an empty list, with the number of rounds
    return request;
}

IsolatedRequest request_of(const nlohmann::json& json) {
    IsolatedRequest request;
    read_options(request.options, json);
    json.at("algorithm").get_to(request.algorithm);
    json.at("preset").get_to(request.preset);
    json.at("settings").get_to(request.settings);
    json.at("devices").get_to(request.devices);
    json.at("work").get_to(request.work.work);
    json.at("samples").get_to(request.work.samples);
    json.at("check").get_to(request.work.check.check);
    json.at("count").get_to(request.work.check.count_work);
    return request;
}

} // namespace tandem
