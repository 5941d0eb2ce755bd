// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/frames.h"
#include "harness/record/journal.h"
#include "harness/plans/cells.h"

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace tandem {

/// The cells that a file of records has already, by what was asked for: devices may take settings otherwise.
class FinishedCells {
public:
    FinishedCells() = default;
    /// Reads what this program, of the same sources, has finished (right or wrong, and not interrupted) into
    /// the file. Throws InputError where it holds records of another schema.
    explicit FinishedCells(const RecordFile& file, const std::string& path);

    bool has(const Cell& cell, const Scene& scene, const FrameRange& range) const;
    /// What its rounds took, whichever sources they were of; none when it was never measured.
    std::optional<double> seconds(const Cell& cell, const Scene& scene, const FrameRange& range) const;

private:
    void take(const nlohmann::ordered_json& record);

    struct Finished {
        bool same_sources = false;
        double seconds = 0;
    };
    std::map<std::string, Finished> by_key_;
};

} // namespace tandem
