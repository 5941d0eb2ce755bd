// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/measurement.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// The state of a cell during its measurement: the results so far, and what this process or another needs to
/// continue.
struct CellState {
    Measurement measurement;
    std::vector<Digest> digests; ///< [frame] of the checking replay; empty before it
    std::int64_t replay_ns = -1; ///< duration of the last replay; -1 before the first
    std::int64_t prepare_ns = 0; ///< duration of the last session's preparation
    std::int64_t spent_ns = 0;   ///< duration of all rounds, with their preparations
    std::uint32_t rounds = 0;    ///< finished rounds
    bool counted = false;        ///< whether the counting replay is finished

    bool is_checked() const { return !digests.empty(); }
};

/// The results of checking and counting, without rounds.
nlohmann::ordered_json checked_json(const CellState& state);
/// The rounds from number `first` on, and the other values that rounds change.
nlohmann::ordered_json rounds_json(const CellState& state, std::uint32_t first);

/// Read the output of the functions above for the same cell, with every number exact. They throw
/// nlohmann::json::exception or InputError for any other input.
void take_checked(CellState& state, const nlohmann::ordered_json& json, const Cell& cell);
void take_rounds(CellState& state, const nlohmann::ordered_json& json);

} // namespace tandem
