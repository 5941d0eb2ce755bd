// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/choosing/search.h"
#include "harness/sampling/measurement.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// How a cell was chosen, as its record has it.
struct Choice {
    /// One of those that were compared; `settings` are those that are not as the preset has them.
    struct Candidate {
        std::string algorithm, preset;
        SettingTexts settings;
        std::optional<double> median_ns; ///< of a replay of `frames`; none: not tried, or failed
        std::size_t replays = 0;
        std::string failure; ///< why it was given up; empty: it was not
    };

    /// The chosen one first, then the others as SearchResult::ranking, then those that failed or were not
    /// tried.
    std::vector<Candidate> candidates;
    std::string scene;                 ///< key of the scene that it was chosen on
    std::size_t first = 0, last = 0;   ///< frames of that scene
    double seconds = 0, preparing = 0; ///< that the search took in replays, and in everything else
    bool from_cache = false;           ///< chosen in an earlier search

    /// Null when no other candidate was timed.
    const Candidate* runner_up() const;
    /// How much longer that takes than the chosen one: 0.1 is 10 %. None without one.
    std::optional<double> margin() const;
};

/// "chosen" of results/record.schema.json.
nlohmann::ordered_json choice_json(const Choice& choice);

/// The same back. Throws nlohmann::json::exception when it is none.
Choice choice_of(const nlohmann::ordered_json& json);

/// A candidate without its times.
Choice::Candidate named(const Cell& cell);

/// Whether it names that cell.
bool names(const Choice::Candidate& candidate, const Cell& cell);

} // namespace tandem
