// SPDX-License-Identifier: MIT
#include "harness/commands/list_cells.h"

#include "base/counted.h"
#include "base/standard_streams.h"
#include "harness/commands/run_records.h"
#include "harness/plans/cell_session.h"
#include "harness/plans/key.h"

#include <fmt/format.h>

namespace tandem {

namespace {

/// What was listed so far.
struct Listed {
    std::size_t cells = 0, unknown = 0; ///< unknown: cells without an estimate
    double seconds = 0;                 ///< of the rounds of the others
};

/// The seconds of a cell's rounds: those of an earlier run where known, else --seconds; none with --repeat.
std::optional<double> seconds_of(const Cell& cell, const Task& task, const RunRecords& records) {
    const auto known = records.seconds(cell, task);
    return known || task.options.repeat ? known : task.options.seconds;
}

/// Lists the cells of a task with their times, and with --keys the keys of their records.
void list(const Task& task, const RunRecords& records, Listed& all) {
    for (const auto& cell : task.cells) {
        const auto seconds = seconds_of(cell, task, records);
        all.seconds += seconds.value_or(0);
        all.unknown += seconds ? 0 : 1;
        put("{:>5}  {:>6}  {}\n", ++all.cells, seconds ? fmt::format("{:.0f} s", *seconds) : "?",
            describe(cell));
        if (!task.options.keys) continue;
        put("{:15}{}\n", "",
            cell.candidates.empty() ? key_of(cell, session_settings(cell, task.scene), task.scene, task.range)
                                    : "its key is that of the choice");
    }
}

/// "8 cells, about 56 s of rounds and 2 cells of unknown duration".
std::string total_text(const Listed& all) {
    if (all.unknown == all.cells)
        return counted(all.cells, "cell") + (all.cells > 0 ? " of unknown duration" : "");
    return fmt::format(
        "{}, about {:.0f} s of rounds{}", counted(all.cells, "cell"), all.seconds,
        all.unknown > 0 ? fmt::format(" and {} of unknown duration", counted(all.unknown, "cell")) : "");
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
            print_message("tandem: {} cannot be listed: {}\n", counted(group.cells.size(), "cell"),
                          error.what());
            ++unopened;
        }
    const auto left_out = records ? records->left_out() : 0;
    put("{}{}; checks against the reference and the truth take extra time\n", total_text(listed),
        left_out > 0 ? fmt::format("; {} more are already in {}", left_out, options.out) : "");
    return unopened > 0 ? 2 : 0;
}

} // namespace tandem
