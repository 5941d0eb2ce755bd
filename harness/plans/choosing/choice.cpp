// SPDX-License-Identifier: MIT
#include "harness/plans/choosing/choice.h"

#include <nlohmann/json.hpp>

namespace tandem {

namespace {

using Json = nlohmann::ordered_json;
using Candidate = Choice::Candidate;

Json candidate_json(const Candidate& c) {
    return {{"algorithm", c.algorithm}, {"preset", c.preset},
            {"settings", c.settings},   {"median_ns", c.median_ns ? Json(*c.median_ns) : Json()},
            {"replays", c.replays},     {"failure", c.failure.empty() ? Json() : Json(c.failure)}};
}

Candidate candidate_of(const Json& json) {
    Candidate c;
    json.at("algorithm").get_to(c.algorithm);
    json.at("preset").get_to(c.preset);
    json.at("settings").get_to(c.settings);
    if (!json.at("median_ns").is_null()) c.median_ns = json.at("median_ns").get<double>();
    json.at("replays").get_to(c.replays);
    if (!json.at("failure").is_null()) json.at("failure").get_to(c.failure);
    return c;
}

} // namespace

const Candidate* Choice::runner_up() const {
    return candidates.size() > 1 && candidates[1].median_ns ? &candidates[1] : nullptr;
}

std::optional<double> Choice::margin() const {
    const auto* second = runner_up();
    const auto& first_median = candidates.front().median_ns;
    if (second == nullptr || !first_median || *first_median <= 0) return std::nullopt;
    return *second->median_ns / *first_median - 1;
}

Json choice_json(const Choice& choice) {
    Json all = Json::array();
    for (const auto& candidate : choice.candidates) all.push_back(candidate_json(candidate));
    const auto margin = choice.margin();
    return {{"by", automatic},
            {"of", choice.candidates.size()},
            {"scene", choice.scene},
            {"frames", {{"first", choice.first}, {"last", choice.last}}},
            {"seconds", choice.seconds},
            {"preparing_seconds", choice.preparing},
            {"from_cache", choice.from_cache},
            {"runner_up", choice.runner_up() != nullptr ? candidate_json(*choice.runner_up()) : Json()},
            {"margin", margin ? Json(*margin) : Json()},
            {"candidates", all}};
}

Choice choice_of(const Json& json) {
    Choice choice;
    json.at("candidates").at(0); // throws when there is no chosen candidate
    for (const auto& candidate : json.at("candidates")) choice.candidates.push_back(candidate_of(candidate));
    json.at("scene").get_to(choice.scene);
    json.at("frames").at("first").get_to(choice.first);
    json.at("frames").at("last").get_to(choice.last);
    json.at("seconds").get_to(choice.seconds);
    json.at("preparing_seconds").get_to(choice.preparing);
    json.at("from_cache").get_to(choice.from_cache);
    return choice;
}

Candidate named(const Cell& cell) {
    Candidate candidate;
    candidate.algorithm = cell.algorithm->name();
    candidate.preset = cell.preset;
    candidate.settings = changes(cell);
    return candidate;
}

bool names(const Candidate& candidate, const Cell& cell) {
    return candidate.algorithm == cell.algorithm->name() && candidate.preset == cell.preset
           && candidate.settings == changes(cell);
}

} // namespace tandem
