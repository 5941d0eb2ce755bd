// SPDX-License-Identifier: MIT
#pragma once

#include "harness/frames/frames.h"
#include "harness/record/journal.h"
#include "harness/plans/cells.h"

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace tandem {

/// The cells that a file of records already contains. The key uses the requested settings, because a device
/// may run with different ones.
class FinishedCells {
public:
    FinishedCells() = default;
    /// Reads the records of finished cells, right or wrong; skips failed and interrupted ones. Throws
    /// InputError when the file contains records of another schema.
    explicit FinishedCells(const RecordFile& file, const std::string& path);

    /// Whether a program of the same sources has finished the cell.
    bool has(const Cell& cell, const Scene& scene, const FrameRange& range) const;
    /// Duration of the cell's rounds in seconds, for any sources; empty when it was never measured.
    std::optional<double> seconds(const Cell& cell, const Scene& scene, const FrameRange& range) const;

private:
    void add(const nlohmann::ordered_json& record);

    struct Finished {
        bool same_sources = false;
        double seconds = 0;
    };
    std::map<std::string, Finished> by_key_;
};

} // namespace tandem
