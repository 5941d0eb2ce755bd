// SPDX-License-Identifier: MIT
#include "harness/plans/choosing/choice.h"

#include "harness/record/types.h"

namespace tandem {

namespace {

using record_parts::Json;
using Candidate = Choice::Candidate;

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

namespace tandem::record_parts {

namespace {

const Fields<Choice::Candidate>& candidate_fields() {
    using Candidate = Choice::Candidate;
    static const Fields<Candidate> fields{
        {"algorithm", text(), "its algorithm", &Candidate::algorithm},
        {"preset", text(), "its preset", &Candidate::preset},
        {"settings", settings_type(), "its settings that are not as the preset has them",
         &Candidate::settings},
        {"median_ns", nullable(number_from(0)),
         "median of its replays in nanoseconds; null when it was not tried or failed", &Candidate::median_ns},
        {"replays", count(), "times it was replayed; one that is slower was dropped earlier",
         &Candidate::replays},
        {"failure", nullable(text()), "why it could not be compared; null when it could",
         [](auto& c) { return known_or_null(c.failure); }}};
    return fields;
}

Type candidate_type() {
    return definition("candidate", candidate_fields().type("one that auto might choose"));
}

Json runner_up_json(const Choice& choice) {
    return choice.runner_up() != nullptr ? candidate_fields().write(*choice.runner_up()) : Json();
}

/// The comparison.
Fields<Choice> comparison_fields() {
    return {{"by", constant(automatic), "as --algorithm named it", [](auto&) { return automatic; }},
            {"of", integer_from(1), "candidates", [](auto& c) { return c.candidates.size(); }},
            {"scene", text(),
             "key of the scene that they were compared on; with from_cache another of the same class",
             &Choice::scene},
            {"frames", frames_fields().type("the frames of it, which a replay runs once").without_columns(),
             "",
             [](auto& c) {
                 return frames_fields().write({c.first, c.last});
             }},
            {"seconds", number_from(0), "seconds of all replays of that comparison", &Choice::seconds},
            {"preparing_seconds", number_from(0), "seconds of its compilations, uploads and first replays",
             &Choice::preparing},
            {"from_cache", boolean(), "compared by an earlier run on such devices with such a scene",
             &Choice::from_cache}};
}

const Fields<Choice>& choice_fields() {
    static const auto fields = comparison_fields().with(
        {{"runner_up", nullable(candidate_type()),
          "the one after the chosen one; null when no other was timed", runner_up_json},
         {"margin", nullable(number()),
          "how much longer a replay of it takes than one of the chosen candidate, by the medians: 0.1 is 10 "
          "%; null "
          "without it",
          &Choice::margin},
         {"candidates", array_of(candidate_type()).with("minItems", 1),
          "all, the chosen one first, the others from the last that was dropped to the first, then what "
          "failed or was "
          "not tried for want of time",
          [](auto& c) { return array_json(candidate_fields(), c.candidates); }}});
    return fields;
}

} // namespace

Type choice_type(const std::string& meaning) { return choice_fields().type(meaning); }

} // namespace tandem::record_parts

namespace tandem {

nlohmann::ordered_json choice_json(const Choice& choice) {
    return record_parts::choice_fields().write(choice);
}

} // namespace tandem
