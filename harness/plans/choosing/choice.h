// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/choosing/search.h"
#include "harness/sampling/measurement.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// How a cell was chosen, as in its record.
struct Choice {
    /// One of the compared cells; `settings` are those that differ from the preset.
    struct Candidate {
        std::string algorithm, preset;
        SettingTexts settings;
        std::optional<double>
            median_ns; ///< median time of a replay of the frames; none: not tried, or failed
        std::size_t replays = 0;
        std::string failure; ///< the reason of a failure; empty: it did not fail
    };

    /// The chosen one first, then the rest in the order of SearchResult::ranking, then those that failed or
    /// were not tried.
    std::vector<Candidate> candidates;
    std::string scene;                 ///< key of the scene that was replayed
    std::size_t first = 0, last = 0;   ///< frames of that scene
    double seconds = 0, preparing = 0; ///< seconds of the search in replays, and in everything else
    bool from_cache = false;           ///< chosen in an earlier search

    /// The second fastest candidate; null when no other candidate was timed.
    const Candidate* runner_up() const;
    /// By how much the runner-up is slower than the chosen one: 0.1 is 10 %. None without a runner-up.
    std::optional<double> margin() const;
};

namespace record_parts {

struct Type;
/// The type of choice_json().
Type choice_type(const std::string& meaning);

} // namespace record_parts

/// "chosen" of results/record.schema.json.
nlohmann::ordered_json choice_json(const Choice& choice);

/// Reads choice_json() back. Throws nlohmann::json::exception when the JSON is no choice.
Choice choice_of(const nlohmann::ordered_json& json);

/// The candidate of a cell, without times.
Choice::Candidate named(const Cell& cell);

/// Whether the candidate names that cell.
bool names(const Choice::Candidate& candidate, const Cell& cell);

} // namespace tandem
