// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands.h"
#include "harness/job.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// A cell that is dealt: what, and what there is of it already.
struct DealtCell {
    Cell cell;
    CellState state;
};

/// The message by which a rank is asked to measure cells, on devices of its own. `options` are those of the
/// scene and frames; `digest` is the scene's.
nlohmann::json hand_json(const RunOptions& options, std::uint64_t seed, std::uint64_t digest,
                         const DeviceGroup& devices, std::span<const DealtCell> cells);

/// The same on the other side.
struct DealtHand {
    explicit DealtHand(const nlohmann::json& message);

    RunOptions options;
    std::uint64_t digest = 0;
    std::vector<std::unique_ptr<Device>> devices; ///< described
    std::vector<DealtCell> cells;
};

/// What a rank says of a cell that has ended: for the record, and for the tables.
nlohmann::json ended_json(const CellResult& result, const nlohmann::ordered_json& record,
                          const std::string& failure);
/// The result back; `cell` as it was dealt or chosen.
CellResult ended_result(const nlohmann::json& message, const Cell& cell);

} // namespace tandem
