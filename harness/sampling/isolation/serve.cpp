// SPDX-License-Identifier: MIT
// The child's side: answers requests.
#include "harness/plans/inputs.h"
#include "harness/sampling/isolation/child_process.h"
#include "harness/sampling/isolation/isolated_sampler.h"
#include "harness/sampling/isolation/request.h"
#include "harness/plans/task.h"
#include "harness/sampling/local_sampler.h"
#include "base/standard_streams.h"
#include "base/error.h"

#include <array>
#include <fmt/format.h>
#include <iostream>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

using nlohmann::json;

/// Does the requested step. Earlier measurements stay in the state when the device fails.
void work(LocalSampler& sampler, const IsolatedWork& step, json& answer) {
    try {
        if (step.work == "check") sampler.check(step.check);
        if (step.work == "round") sampler.round(step.samples);
        if (step.work == "count" || (step.work == "check" && step.check.count_work)) sampler.count_work();
    } catch (const DeviceError& error) {
        answer["failure"] = error.what();
    } catch (const std::bad_alloc&) {
        answer["failure"] = "out of host memory; use fewer bodies or frames";
    }
}

json answer_to(const json& message) {
    auto request = request_of(message);
    const auto backends = open_backends(std::array{request.devices}, {});
    const auto group = open_devices(request.options, backends, std::array{request.devices}).front();
    const auto& traversal = algorithm(request.algorithm);
    const auto task = open_task(
        request.options, {make_cell(traversal, preset(traversal, request.preset), request.settings, group)});
    const auto cache = checks_folder(request.options);
    References references(task.scene, task.range, cache);
    Truths truths(task.scene, task.range, request.options.truth, request.options.truth_contacts, cache);
    if (request.options.truth != TruthAmount::none) request.work.check.truths = &truths;
    CellState state;
    if (!message.at("checked").is_null()) take_checked(state, message["checked"], task.cells.front());
    take_rounds(state, message.at("rounds"));
    const auto first = state.rounds;
    LocalSampler sampler(task.cells.front(), task.scene, task.range, references, std::move(state));
    json answer = json::object();
    work(sampler, request.work, answer);
    answer["checked"] =
        sampler.state().is_checked() ? checked_json(sampler.state()) : nlohmann::ordered_json();
    answer["rounds"] = rounds_json(sampler.state(), first);
    return answer;
}

} // namespace

int isolated_command() {
    end_with_parent();
    for (std::string line; std::getline(std::cin, line);) {
        json answer;
        try {
            answer = answer_to(json::parse(line));
        } catch (const InputError& error) {
            answer = {{"input_error", error.what()}};
        } catch (const std::exception& error) {
            answer = {{"failure", error.what()}};
        }
        put_bytes(fmt::format("\n{}\n{}", answer.dump(), end_of_answer));
        flush_output();
    }
    return 0;
}

} // namespace tandem
