// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/task.h"
#include "harness/record/finished_cells.h"
#include "harness/record/unfinished.h"

namespace tandem {

/// The file that gets the records of a run, and what earlier runs left there for --resume. Under MPI only
/// rank 0 reads and writes; its decisions are those of all ranks.
class RunRecords {
public:
    /// Opens the files. Called only after the input was checked, so that a mistake leaves no empty files
    /// behind. `options` must outlive this. Throws InputError.
    RunRecords(const RunOptions& options, RankTeam* team);

    /// Removes the cells that the file already has, and counts them.
    void leave_out_finished(Task& task);
    std::size_t left_out() const { return left_out_; }
    /// Seconds of a cell's rounds in an earlier run; empty when it was never measured.
    std::optional<double> seconds(const Cell& cell, const Task& task) const {
        return finished_.seconds(cell, task.scene, task.range);
    }
    RecordFile& file() { return *file_; }
    const RecordFile& file() const { return *file_; }
    Unfinished& unfinished() { return unfinished_; }

private:
    RankTeam* team_;
    std::optional<RecordFile> file_;
    FinishedCells finished_;
    Unfinished unfinished_;
    std::size_t left_out_ = 0;
};

} // namespace tandem
