// SPDX-License-Identifier: MIT
#include "harness/commands/list_cells.h"

#include "base/standard_streams.h"
#include "harness/commands/run_records.h"
#include "harness/plans/cell_session.h"
#include "harness/plans/key.h"

namespace tandem {

namespace {

/// What was listed so far.
struct Listed {
    std::size_t cells = 0, unknown = 0; ///< unknown: cells without an estimate
    double seconds = 0;                 ///< of the rounds of the others
};

/// Lists the cells of a task: their time is that of an earlier run where known, else --seconds.
void list(const Task& task, const RunRecords& records, Listed& all) {
    for (const auto& cell : task.cells) {
        const auto known = records.seconds(cell, task);
        if (!known && task.options.repeat) ++all.unknown;
        all.seconds += known ? *known : (task.options.repeat ? 0 : task.options.seconds);
        put("{:>5}  {}\n       {}\n", ++all.cells, describe(cell),
            cell.candidates.empty() ? key_of(cell, session_settings(cell, task.scene), task.scene, task.range)
                                    : "its key is that of the choice");
    }
}

} // namespace

int list_cells(const RunGroups& all, const RunOptions& options, RankTeam* team) {
    Listed listed;
    std::optional<RunRecords> records;
    std::size_t unopened = 0;
    for (const auto& group : all.groups()) try {
            const auto task = all.open(group, print_skipped);
            if (!records) records.emplace(options, team);
            records->leave_out_finished(*task);
            print_scene(*task);
            list(*task, *records, listed);
        } catch (const InputError& error) {
            if (all.groups().size() == 1) throw;
            print_message("tandem: {} cells cannot be listed: {}\n", group.cells.size(), error.what());
            ++unopened;
        }
    const auto left_out = records ? records->left_out() : 0;
    put("{} cells, about {:.0f} s of rounds{}{}; checks against the reference and the truth take extra "
        "time\n",
        listed.cells, listed.seconds,
        listed.unknown > 0 ? fmt::format(" and {} cells of unknown duration", listed.unknown) : "",
        left_out > 0 ? fmt::format("; {} more are already in {}", left_out, options.out) : "");
    return unopened > 0 ? 2 : 0;
}

} // namespace tandem
