// SPDX-License-Identifier: MIT
// The side of the process that answers.
#include "harness/choosing/choose.h"
#include "harness/inputs.h"
#include "harness/isolation/child_process.h"
#include "harness/isolation/described.h"
#include "harness/isolation/isolated_sampler.h"
#include "harness/isolation/request.h"
#include "harness/job.h"
#include "harness/sampling/local_sampler.h"
#include "harness/standard_streams.h"
#include "scenes/error.h"

#include <array>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

using nlohmann::json;

/// Devices that stay open from request to request.
class OpenDevices {
public:
    DeviceGroup open(const RunOptions& options, const std::string& names) {
        auto& backends = opened_[{names, options.memory}];
        if (backends.empty()) backends = open_backends(std::array{names}, {});
        return open_devices(options, backends, std::array{names}).front();
    }

private:
    std::map<std::pair<std::string, std::uint64_t>, std::vector<BackendReport>> opened_; ///< by names, limit
};

/// Does what was asked for; a failure of the device leaves what was measured before.
void work(LocalSampler& sampler, const IsolatedWork& asked, json& answer) {
    try {
        if (asked.work == "check") sampler.check(asked.check);
        if (asked.work == "round") sampler.round(asked.samples);
        if (asked.work == "count" || (asked.work == "check" && asked.check.count_work)) sampler.count_work();
    } catch (const DeviceError& error) {
        answer["failure"] = error.what();
    } catch (const std::bad_alloc&) {
        answer["failure"] = "out of host memory; use fewer bodies or frames";
    }
}

json describe(const json& asked) {
    return {
        {"backends", backends_json(open_backends(asked.at("devices").get<std::vector<std::string>>(), {}))}};
}

/// A cell of auto, decided.
json choose(const json& asked, OpenDevices& devices) {
    RunOptions options;
    take_options(options, asked);
    const auto group = devices.open(options, asked.at("devices").get<std::string>());
    auto job = open_job(options, {cell_of(asked.at("cell"), group)});
    ChoosingOptions choosing;
    asked.at("seconds").get_to(choosing.seconds);
    asked.at("afresh").get_to(choosing.afresh);
    choose(job.cells.front(), job.scene, job.range, choosing);
    return {{"cell", cell_json(job.cells.front())}};
}

json answer_to(const json& asked, OpenDevices& devices) {
    if (asked.at("work") == "describe") return describe(asked);
    if (asked.at("work") == "choose") return choose(asked, devices);
    auto request = request_of(asked);
    const auto group = devices.open(request.options, request.devices);
    const auto& traversal = algorithm(request.algorithm);
    const auto job = open_job(
        request.options, {make_cell(traversal, preset(traversal, request.preset), request.settings, group)});
    const auto kept = checks_folder(request.options);
    References references(job.scene, job.range, kept);
    Truths truths(job.scene, job.range, request.options.truth, request.options.truth_contacts, kept);
    if (request.options.truth != TruthAmount::none) request.work.check.truths = &truths;
    CellState state;
    if (!asked.at("checked").is_null()) take_checked(state, asked["checked"], job.cells.front());
    take_rounds(state, asked.at("rounds"));
    const auto first = state.rounds;
    LocalSampler sampler(job.cells.front(), job.scene, job.range, references, std::move(state));
    json answer = json::object();
    work(sampler, request.work, answer);
    answer["checked"] = sampler.state().is_checked() ? checked_json(sampler.state()) : json();
    answer["rounds"] = rounds_json(sampler.state(), first);
    return answer;
}

} // namespace

int isolated_command() {
    end_with_parent();
    OpenDevices devices;
    for (std::string line; std::getline(std::cin, line);) {
        json answer;
        try {
            answer = answer_to(json::parse(line), devices);
        } catch (const InputError& error) {
            answer = {{"input_error", error.what()}};
        } catch (const std::exception& error) {
            answer = {{"failure", error.what()}};
        }
        put("\n{}\n{}", answer.dump(), end_of_answer);
        flush_output();
    }
    return 0;
}

} // namespace tandem
