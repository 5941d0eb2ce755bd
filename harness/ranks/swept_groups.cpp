// SPDX-License-Identifier: MIT
#include "harness/ranks/swept_groups.h"

#include "harness/key.h"
#include "harness/standard_streams.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem {

SweptGroup open_group(const RunOptions& options, const CellGroup& group, const FinishedCells& finished,
                      Unfinished& unfinished) {
    SweptGroup swept;
    swept.options = options;
    swept.options.scene = group.scene;
    swept.options.frames = group.frames;
    const auto job = open_job(swept.options, group.cells,
                              options.plan->skips_impossible ? Unfit(tell_skipped) : Unfit(refuse));
    swept.text = scene_text(job.scene, job.range);
    swept.digest = job.scene.digest;
    for (const auto& cell : job.cells) {
        const auto key = key_of(cell, cell.settings, job.scene, job.range);
        if (cell.candidates.empty() && finished.has(cell, job.scene, job.range)) {
            unfinished.forget(key);
            ++swept.left_out;
            continue;
        }
        swept.cells.push_back(cell);
        swept.keys.push_back(key);
        swept.seconds.push_back(finished.seconds(cell, job.scene, job.range));
    }
    swept.results.resize(swept.cells.size());
    swept.ranks.resize(swept.cells.size(), -1);
    return swept;
}

void print_group(const SweptGroup& group) {
    std::vector<const CellResult*> results;
    std::vector<std::string> where;
    for (std::size_t i = 0; i < group.cells.size(); ++i)
        if (group.results[i]) {
            results.push_back(&*group.results[i]);
            where.push_back(fmt::format("{} of rank {}", name_of(group.cells[i].devices), group.ranks[i]));
        }
    if (results.empty()) return;
    put_text(group.text);
    print_results(results, where);
}

double list_group(const SweptGroup& group, const Roster& roster, std::size_t& number) {
    double seconds = 0;
    if (!group.cells.empty()) put_text(group.text);
    for (std::size_t i = 0; i < group.cells.size(); ++i) {
        const auto& cell = group.cells[i];
        const auto ranks = roster.ranks_with(models_of(cell.devices));
        seconds += group.seconds[i].value_or(group.options.repeat ? 0 : group.options.seconds);
        put("{:>5}  {}; rank{} {}\n       {}\n", ++number, describe(cell), ranks.size() == 1 ? "" : "s",
            fmt::join(ranks, ", "), group.keys[i]);
    }
    return seconds;
}

} // namespace tandem
