// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/measurement.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// A cell that is being measured: what it gave so far, and what going on with it takes, in this process or in
/// another.
struct CellState {
    Measurement measurement;
    std::vector<Digest> digests; ///< [frame] of the checking replay; empty before it
    std::int64_t replay_ns = -1; ///< of the last replay; -1 before the first
    std::int64_t prepare_ns = 0; ///< of the last session
    std::int64_t spent_ns = 0;   ///< of all rounds, with their preparations
    std::uint32_t rounds = 0;    ///< taken
    bool counted = false;        ///< the replay that counts work is done

    bool is_checked() const { return !digests.empty(); }
};

/// The state but for its rounds: what checking and counting gave.
nlohmann::json checked_json(const CellState& state);
/// The rounds from number `first` on, and what they changed of the rest.
nlohmann::json rounds_json(const CellState& state, std::uint32_t first);

/// Takes over what the functions above have written of the same cell, every number exactly. Throw
/// nlohmann::json::exception, or InputError, when they have not.
void take_checked(CellState& state, const nlohmann::json& json, const Cell& cell);
void take_rounds(CellState& state, const nlohmann::json& json);

} // namespace tandem
