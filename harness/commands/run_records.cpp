// SPDX-License-Identifier: MIT
#include "harness/commands/run_records.h"

#include "harness/plans/key.h"
#include "harness/plans/rank_team.h"

namespace tandem {

RunRecords::RunRecords(const RunOptions& options, RankTeam* team) : team_(team) {
    together(team_, [&] {
        const bool writes = is_first(team_);
        const bool opens = writes && (!options.dry_run || options.resume);
        file_.emplace(opens ? options.out : std::string());
        if (options.resume && writes) finished_ = FinishedCells(*file_, options.out);
        if (!options.dry_run && writes) unfinished_ = Unfinished(options.out, options.resume);
    });
}

void RunRecords::leave_out_finished(Task& task) {
    left_out_ += std::erase_if(task.cells, [&](const Cell& cell) {
        if (!cell.candidates.empty()) return false;
        if (!decided(team_, finished_.has(cell, task.scene, task.range))) return false;
        unfinished_.forget(key_of(cell, cell.settings, task.scene, task.range));
        return true;
    });
}

} // namespace tandem
