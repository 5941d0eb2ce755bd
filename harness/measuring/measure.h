// SPDX-License-Identifier: MIT
#pragma once

#include "base/progress.h"
#include "harness/plans/task.h"
#include "harness/record/journal.h"
#include "harness/record/unfinished.h"
#include "harness/sampling/rounds.h"

namespace tandem {

/// How the cells of a task are measured.
struct Measuring {
    CheckOptions check;
    StoppingCriterion stopping;
    std::uint64_t seed = 0;
    Unfinished* unfinished = nullptr; ///< stores the rounds of unfinished cells; null: they are not stored
    std::function<void()> before_round = [] {};
    std::function<bool()> stop = [] { return false; };
};

/// The result of a cell.
struct CellResult {
    const Cell* cell = nullptr;
    Measurement measurement;
    int code = 0; ///< 0: right; 1: the answer is wrong; 3: the device failed or the record was not written
    bool measured = false; ///< the device did not fail; the record may still be missing
    bool is_wide = false;  ///< its interval is wider than asked for
};

/// How a measurement reports: `progress` shows what runs, `ended` takes each cell's result as it ends.
struct CellsListener {
    const Progress& progress;
    std::function<void(const CellResult&)> ended;
    std::size_t later_cells = 0; ///< cells that are measured afterwards, for the estimated time left
};

/// Measures the cells as one group. Appends a record for each cell as it ends, also when its device failed,
/// before the listener gets its result. Stops when a record cannot be written. Returns whether the
/// measurement was interrupted: then cells that had not begun have no record.
bool measure_cells(const Task& task, std::span<const Cell> cells, References& references,
                   const Measuring& measuring, RecordFile& file, const CellsListener& listener);

/// How many rounds other work disturbed, and the most frequent reason; empty when there are none.
std::string disturbed_text(std::span<const CellResult* const> results);

/// Other reasons to doubt times, such as drift, over all cells; empty when there are none.
std::string doubts(std::span<const CellResult* const> results);

} // namespace tandem
