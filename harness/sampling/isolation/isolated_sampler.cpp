// SPDX-License-Identifier: MIT
// The parent's side: sends requests to child processes.
#include "harness/sampling/isolation/isolated_sampler.h"

#include "harness/sampling/isolation/child_process.h"
#include "harness/program/interrupt.h"
#include "harness/sampling/isolation/request.h"
#include "base/error.h"

#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

/// The answer is the last line, because some libraries print text before it. Throws DeviceError without an
/// answer.
nlohmann::json answer_of(const ChildResult& result) {
    auto text = result.output;
    while (text.ends_with('\n')) text.pop_back();
    auto json = nlohmann::json::parse(text.substr(text.rfind('\n') + 1), nullptr, false);
    if (json.is_object()) return json;
    throw DeviceError(
        fmt::format("its process {}", result.failure.empty() ? "ended without an answer" : result.failure));
}

/// Sends a request to a new child process. Throws DeviceError when it ends without an answer, InputError
/// when it rejects the request, and Interrupted when `stop` returned true first.
nlohmann::json ask_child(const nlohmann::json& request, double timeout, const std::function<bool()>& stop) {
    ChildProcess child(std::array<std::string, 1>{"isolated"});
    const auto result = child.ask(request.dump(), timeout, stop);
    if (result.stopped) throw Interrupted();
    auto answer = answer_of(result);
    if (answer.contains("input_error")) throw InputError(answer["input_error"].get<std::string>());
    return answer;
}

} // namespace

void leave_out_this_process(std::span<RoundConditions> rounds, std::uint32_t first) {
    for (auto& round : rounds)
        if (round.round >= first)
            for (auto* reading : {&round.before, &round.after})
                for (auto& gpu : reading->gpus)
                    if (gpu.processes && *gpu.processes > 0) --*gpu.processes;
}

void IsolatedSampler::ask(const char* work, const CheckOptions& options, std::size_t samples) {
    const auto request = request_json(options_, *this, {work, samples, options});
    const auto answer = ask_child(request, options_.timeout, stop_);
    if (answer.contains("checked") && !answer["checked"].is_null()) {
        take_checked(state_, answer["checked"], cell_);
        const auto first = state_.rounds;
        take_rounds(state_, answer["rounds"]);
        leave_out_this_process(state_.measurement.conditions, first);
    }
    if (answer.contains("failure")) throw DeviceError(answer["failure"].get<std::string>());
}

/// The same process also counts work.
void IsolatedSampler::do_check(const CheckOptions& options) {
    options.progress(fmt::format("{}: checking in another process", describe(cell_)), 0);
    ask("check", options, 0);
}

void IsolatedSampler::do_round(std::size_t samples) { ask("round", {}, samples); }

void IsolatedSampler::do_count_work() { ask("count", {}, 0); }

} // namespace tandem
