// SPDX-License-Identifier: MIT
#include "harness/paper/steps.h"

#include "scenes/error.h"

#include <fmt/format.h>

namespace tandem {

namespace {

using Json = nlohmann::ordered_json;

void replace(std::string& text, std::string_view what, const std::string& by) {
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
}

std::string placed(std::string text, const PaperPlace& place) {
    replace(text, "{device}", place.device);
    replace(text, "{quarter}", std::to_string(place.quarter));
    return text;
}

/// In every text of it.
Json placed(const Json& json, const PaperPlace& place) {
    if (json.is_string()) return placed(json.get<std::string>(), place);
    if (!json.is_structured()) return json;
    auto result = json;
    for (auto& part : result) part = placed(part, place);
    return result;
}

/// A plan is run with its records resumed, as every file of a step is.
std::vector<std::string> run_of_plan(const std::string& name) {
    return {"run", fmt::format("plans/{}.json", name), "--resume", "--out",
            fmt::format("records/{}.jsonl", name)};
}

PaperStep step_of(const Json& json, const PaperPlace& place) {
    PaperStep step;
    step.name = json.at("name");
    step.says = json.at("says");
    step.seconds = json.at("seconds");
    if (json.contains("plan")) {
        step.plan = placed(json.at("plan"), place);
        step.command = run_of_plan(step.name);
    } else {
        for (const auto& word : json.at("command"))
            step.command.push_back(placed(word.get<std::string>(), place));
    }
    return step;
}

} // namespace

std::vector<PaperStep> paper_steps(std::string_view size, const PaperPlace& place) {
    const auto text = paper_plan(size);
    if (text.empty()) throw InputError(fmt::format("--size {}: give small or full", size));
    std::vector<PaperStep> steps;
    const auto plan = Json::parse(text);
    for (const auto& json : plan.at("steps")) steps.push_back(step_of(json, place));
    return steps;
}

} // namespace tandem
