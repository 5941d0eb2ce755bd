// SPDX-License-Identifier: MIT
#include "harness/commands/run_groups.h"

#include "base/counted.h"
#include "base/standard_streams.h"
#include "harness/plans/inputs.h"
#include "harness/plans/key.h"
#include "harness/plans/rank_team.h"

#include <array>
#include <fmt/format.h>

namespace tandem {

namespace {

void print_left_out(const CellGroups& all) {
    if (all.repeated > 0)
        print_message("tandem: {} named more than once; each is measured once\n",
                      counted_are(all.repeated, "cell"));
    for (const auto& [reason, count] : all.impossible)
        print_message("tandem: skipped {}: {}\n", counted(count, "impossible combination"), reason);
}

/// The keys of the cells of a task, in order.
std::string keys_of(const Task& task) {
    std::string keys;
    for (const auto& cell : task.cells) keys += key_of(cell, cell.settings, task.scene, task.range) + "\n";
    return keys;
}

} // namespace

void print_skipped(const InputError& error) { print_message("tandem: skipped a cell: {}\n", error.what()); }

RunGroups::RunGroups(const RunOptions& options, RankTeam* team) : options_(options), team_(team) {
    together(team_, [&] {
        const auto plan = plan_of(options_);
        const auto names = devices_of(plan);
        backends_ = open_named(names, options_.require);
        limit_memory(options_, backends_);
        const auto choose = [&](const auto& asked) {
            if (team_ == nullptr || !asks_for_each(asked[0])) return choose_devices(backends_, asked);
            return choose_devices(backends_, std::array{team_->own_of_each(asked[0], backends_)});
        };
        all_ = make_groups(plan, choose, options_.shard);
        keep_matching(all_, options_.filter, options_.shard);
        if (all_.groups.empty() && !all_.impossible.empty() && options_.shard.of <= 1)
            throw InputError(fmt::format("no cell is possible: {}", all_.impossible.begin()->first));
        if (all_.groups.empty() && all_.excluded > 0 && options_.shard.of <= 1)
            throw InputError(fmt::format("'exclude' of the plan leaves out {}; none is left",
                                         all_.excluded == 1 ? "its only cell"
                                                            : fmt::format("all {} cells", all_.excluded)));
        print_left_out(all_);
        if (options_.shard.of > 1)
            put("shard {}/{}: {} of {} groups\n", options_.shard.index, options_.shard.of, all_.groups.size(),
                all_.numbered);
        check_one_group();
    });
    if (team_ != nullptr && !all_.groups.empty()) open_team();
}

/// Opens the team with the one device of this rank: all cells use the same.
void RunGroups::open_team() {
    for (auto& group : all_.groups)
        for (auto& cell : group.cells) {
            cell.team = team_;
            for (auto& candidate : cell.candidates) candidate.team = team_;
        }
    team_->open(*all_.groups.front().cells.front().devices.front());
}

/// Dumps and traces are written for the first finished cell, so there must be only one group.
void RunGroups::check_one_group() const {
    if (all_.groups.size() <= 1) return;
    if (options_.has_dumps())
        throw InputError("dumps need one scene and one range of its frames; name one of each");
    if (!options_.trace.empty())
        throw InputError("--trace needs one scene and one range of its frames; name one of each");
}

std::unique_ptr<Task> RunGroups::open(const CellGroup& group, const Unfit& unfit) const {
    auto own = options_;
    own.scene = group.scene;
    own.frames = group.frames;
    const bool skips = options_.plan && options_.plan->skips_impossible;
    std::unique_ptr<Task> task;
    together(team_, [&] {
        task = std::make_unique<Task>(open_scene(own), own, group.cells, skips ? unfit : Unfit(refuse));
    });
    if (team_ != nullptr) team_->check_same(keys_of(*task));
    return task;
}

} // namespace tandem
