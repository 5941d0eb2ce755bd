// SPDX-License-Identifier: MIT
#include "harness/choosing/choice.h"

#include "harness/fields/types.h"
#include "base/statistics.h"

#include <algorithm>

namespace tandem::record_parts {

namespace {

struct Candidate {
    const Cell& cell;
    std::vector<std::int64_t> times{};
    std::string failure{};

    Json median_ns() const { return times.empty() ? Json() : Json(median(times)); }
};

struct Choice {
    const Race& race;
    std::vector<Candidate> candidates;
    std::string scene;
    std::size_t first = 0, frames = 0;

    /// The second fastest; null when no other was timed.
    const Candidate* runner_up() const {
        return candidates.size() > 1 && !candidates[1].times.empty() ? &candidates[1] : nullptr;
    }
};

const Fields<Candidate>& candidate_fields() {
    static const Fields<Candidate> fields{
        {"algorithm", text(), "its algorithm", [](auto& c) { return c.cell.algorithm->name(); }},
        {"preset", text(), "its preset", [](auto& c) { return c.cell.preset; }},
        {"settings", settings_type(), "its settings that are not as the preset has them",
         [](auto& c) { return changes(c.cell); }},
        {"median_ns", nullable(number_from(0)),
         "median of its replays in nanoseconds; null when it was not tried or failed", &Candidate::median_ns},
        {"replays", count(), "times it was replayed; one that is slower was dropped earlier",
         [](auto& c) { return c.times.size(); }},
        {"failure", nullable(text()), "why it could not be compared; null when it could",
         [](auto& c) { return known_or_null(c.failure); }}};
    return fields;
}

Type candidate_type() {
    return definition("candidate", candidate_fields().type("one that auto might choose"));
}

const Fields<Choice>& choice_fields() {
    static const Fields<Choice> fields{
        {"by", constant(automatic), "as --algorithm named it", [](auto&) { return automatic; }},
        {"of", integer_from(1), "candidates", [](auto& c) { return c.candidates.size(); }},
        {"scene", text(),
         "key of the scene that they were compared on; with from_cache another of the same class",
         &Choice::scene},
        {"frames", frames_fields().type("the frames of it, which a replay runs once").without_columns(), "",
         [](auto& c) {
             return frames_fields().write({c.first, c.first + c.frames - 1});
         }},
        {"seconds", number_from(0), "seconds of all replays of that comparison",
         [](auto& c) { return c.race.measured(); }},
        {"preparing_seconds", number_from(0), "seconds of its compilations, uploads and first replays",
         [](auto& c) { return c.race.preparing(); }},
        {"from_cache", boolean(), "compared by an earlier run on such devices with such a scene",
         [](auto&) { return false; }},
        {"runner_up", nullable(candidate_type()),
         "the one after the chosen one; null when no other was timed",
         [](auto& c) { return c.runner_up() ? candidate_fields().write(*c.runner_up()) : Json(); }},
        {"margin", nullable(number()),
         "how much longer a replay of it takes than one of the chosen candidate, by the medians: 0.1 is 10 "
         "%; null without it",
         [](auto& c) {
             const auto fastest = c.runner_up() ? median(c.candidates[0].times) : 0;
             return fastest > 0 ? Json(median(c.runner_up()->times) / fastest - 1) : Json();
         }},
        {"candidates", array_of(candidate_type()).with("minItems", 1),
         "all, the chosen one first, the others from the last that was dropped to the first, then what "
         "failed or was not tried for want of time",
         [](auto& c) { return array_json(candidate_fields(), c.candidates); }}};
    return fields;
}

} // namespace

Type choice_type(const std::string& meaning) { return choice_fields().type(meaning); }

} // namespace tandem::record_parts

namespace tandem {

nlohmann::ordered_json choice_json(const Race& race, const std::vector<std::size_t>& ranking,
                                   const std::string& scene, std::size_t first, std::size_t frames) {
    auto order = ranking;
    for (const bool failed : {true, false})
        for (std::size_t i = 0; i < race.candidates().size(); ++i)
            if (race.failure(i).empty() != failed && std::ranges::find(order, i) == order.end())
                order.push_back(i);
    record_parts::Choice choice{race, {}, scene, first, frames};
    for (const auto i : order)
        choice.candidates.push_back({race.candidates()[i], race.times(i), race.failure(i)});
    return record_parts::choice_fields().write(choice);
}

bool is_chosen(const Cell& cell, const nlohmann::ordered_json& choice) {
    const auto own = record_parts::candidate_fields().write({cell});
    return std::ranges::all_of(std::array{"algorithm", "preset", "settings"},
                               [&](const char* name) { return own[name] == choice["candidates"][0][name]; });
}

} // namespace tandem
