// SPDX-License-Identifier: MIT
#include "harness/commands/run.h"

#include "base/counted.h"
#include "base/progress.h"
#include "base/standard_streams.h"
#include "harness/choosing/choose.h"
#include "harness/commands/dumps.h"
#include "harness/commands/list_cells.h"
#include "harness/commands/results.h"
#include "harness/commands/run_groups.h"
#include "harness/commands/run_records.h"
#include "harness/measuring/measure.h"
#include "harness/plans/rank_team.h"
#include "harness/program/cache_folder.h"
#include "harness/program/environment.h"
#include "harness/program/interrupt.h"
#include "harness/program/mpi_environment.h"
#include "harness/program/run_on_ranks.h"
#include "harness/sampling/replays.h"
#include "harness/sampling/turns.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <random>

namespace tandem {

namespace {

/// Replays the frames and does nothing else, so that a profiler records only the algorithm. Profiling starts
/// after a first replay, which compiles kernels and grows buffers. Throws Interrupted.
int profile(const Task& task, std::size_t times) {
    for (const auto& cell : task.cells) {
        Replays replays(cell, task.scene, task.range,
                        [&cell] { return decided(cell.team, Interrupt::asked()); });
        const auto replay = [&] { replays.timed([](std::size_t, const FrameResult&) {}); };
        replay();
        for (auto* device : cell.devices) device->profile(true);
        for (std::size_t i = 0; i < times; ++i) replay();
        for (auto* device : cell.devices) device->profile(false);
        put("{}: replayed frames {}:{} {} times; nothing measured or recorded\n", describe(cell),
            task.range.first(), task.range.last(), times);
    }
    return 0;
}

/// Chooses the algorithm and settings of each `auto` cell. Throws Interrupted.
void choose_cells(Task& task, const RunOptions& options, const Progress& progress) {
    ChoosingOptions choosing;
    choosing.seconds = options.choose_seconds;
    choosing.afresh = options.choose_afresh;
    choosing.stop = Interrupt::asked;
    for (std::size_t i = 0; i < task.cells.size(); ++i) {
        choosing.progress = [&](std::string_view text) {
            if (text.empty())
                progress.clear();
            else
                progress.show(fmt::format("{}/{} {}", i + 1, task.cells.size(), text));
        };
        choose(task.cells[i], task.scene, task.range, choosing);
    }
}

/// How cells are measured according to the options. The caller sets the truths.
Measuring measuring_of(const RunOptions& options) {
    Measuring measuring;
    measuring.check = {options.check, options.count, nullptr};
    measuring.stopping = {options.repeat, options.noise, options.seconds};
    const auto turns = Turns::from_environment();
    measuring.seed = options.seed ? *options.seed : turns ? turns->seed() : std::random_device{}();
    if (turns) measuring.before_round = [turns = *turns] { turns.wait(Interrupt::asked); };
    return measuring;
}

void refuse_what_ranks_cannot(const RunOptions& options) {
    if (options.isolate)
        throw InputError("--isolate runs each cell in a process of its own, but MPI ranks share each cell; "
                         "leave --isolate out");
    if (!options.trace.empty())
        throw InputError("--trace records one process; run it without the MPI launcher");
}

/// One run of the command: measures its groups of cells one after another.
class Run {
public:
    Run(const RunGroups& all, const RunOptions& options, RankTeam* team)
        : all_(all), options_(options), team_(team), progress_(options.quiet) {}
    int go();

private:
    using Results = std::map<const Cell*, CellResult>;

    void open_files();
    int work_on(Task& task);
    int measure(const Task& task);
    void conclude(const Task& task, const Results& results);
    void write_dumps(const Task& task, const Results& results);
    int end(int code);

    const RunGroups& all_;
    const RunOptions& options_;
    RankTeam* const team_; ///< null: one process
    std::optional<RunRecords> records_;
    std::optional<Dumps> dumps_;
    Progress progress_;
    std::size_t later_cells_ = 0; ///< of the groups after that which is measured
    std::size_t measured_ = 0, verdicts_ = 0;
    bool interrupted_ = false;
    bool dump_ended_ = false; ///< a signal ended the dump, which is not written
};

void Run::open_files() {
    if (records_) return;
    records_.emplace(options_, team_);
    together(team_, [&] { dumps_.emplace(options_, is_first(team_)); });
}

int Run::measure(const Task& task) {
    Truths truths(task.scene, task.range, options_.truth, options_.truth_contacts, checks_folder(options_));
    auto measuring = measuring_of(options_);
    if (options_.truth != TruthAmount::none) measuring.check.truths = &truths;
    measuring.unfinished = &records_->unfinished();
    measuring.stop = Interrupt::asked;
    measuring.seed = decided(team_, measuring.seed);
    References references(task.scene, task.range, checks_folder(options_));
    Results results;
    int code = 0;
    const auto ended = [&](const CellResult& result) {
        code = std::max(code, result.code);
        results.emplace(result.cell, result);
    };
    interrupted_ = measure_cells(task, task.cells, references, measuring, records_->file(),
                                 {progress_, ended, later_cells_});
    measured_ += results.size();
    conclude(task, results);
    if (!interrupted_) write_dumps(task, results);
    return code;
}

/// Prints the results and records the verdicts on them.
void Run::conclude(const Task& task, const Results& results) {
    std::vector<const CellResult*> in_order;
    for (const auto& cell : task.cells)
        if (const auto found = results.find(&cell); found != results.end())
            in_order.push_back(&found->second);
    const auto rows = rows_of(task, in_order);
    const auto verdicts = verdicts_of(rows);
    print_results(rows, verdicts, task, in_order);
    auto& file = records_->file();
    if (interrupted_ || file.failed() || !is_first(team_)) return;
    for (const auto& verdict : verdicts)
        verdicts_ += file.append_or_report(verdict_record(verdict, rows, task.scene, task.range)) ? 1 : 0;
}

/// Dumps come last, because a dump that cannot be written ends the run.
void Run::write_dumps(const Task& task, const Results& results) {
    const auto first = std::ranges::find_if(task.cells, [&](const Cell& cell) {
        const auto found = results.find(&cell);
        return found != results.end() && found->second.measured;
    });
    if (first == task.cells.end() || decided(team_, records_->file().failed())) return;
    try {
        dumps_->write(*first, task);
    } catch (const Interrupted&) {
        interrupted_ = dump_ended_ = true;
    }
}

/// Prints the last messages and returns the exit code.
int Run::end(int code) {
    if (options_.profile > 0) return interrupted_ ? Interrupt::exit_code() : code;
    const auto& file = records_->file();
    const bool lacks_dump = measured_ == 0 && options_.has_dumps();
    if (records_->left_out() > 0)
        put("{} already in {}{}\n", counted_are(records_->left_out(), "cell"), options_.out,
            lacks_dump ? "; no dump is written: run again without --resume" : "");
    if (!options_.out.empty()) {
        const auto count = file.appended() - verdicts_;
        put("{} appended to {}\n", counted(count, "record"), options_.out);
    }
    if (!interrupted_ && !file.failed()) records_->unfinished().remove();
    if (!interrupted_ || file.failed()) return code;
    const bool can_resume = !options_.out.empty() && !dump_ended_;
    print_message("tandem: interrupted; {} measured{}{}\n", counted_are(measured_, "cell"),
                  dump_ended_ ? "; the dump is not written: run again without --resume" : "",
                  can_resume
                      ? fmt::format("; to continue: {}{}", command_line(), options_.resume ? "" : " --resume")
                      : "");
    return Interrupt::exit_code();
}

/// Measures the cells of a group, or replays them for a profiler. Returns the exit code.
int Run::work_on(Task& task) {
    try {
        choose_cells(task, options_, progress_);
        return options_.profile > 0 ? profile(task, options_.profile) : measure(task);
    } catch (const Interrupted&) {
        interrupted_ = true;
        return 0;
    }
}

int Run::go() {
    const auto& groups = all_.groups();
    if (groups.empty()) return 0;
    // Open all groups first, so that a mistake in the last scene is found before the first is measured.
    if (groups.size() > 1)
        for (const auto& group : groups) all_.open(group, leave_out);
    report_cache_folder();
    const Interrupt interrupt(is_first(team_) ? Interrupt::stopping : std::string_view());
    int code = 0;
    for (const auto& group : groups) later_cells_ += group.cells.size();
    for (const auto& group : groups) {
        later_cells_ -= group.cells.size();
        const auto task = all_.open(group, print_skipped);
        open_files();
        records_->leave_out_finished(*task);
        if (task->cells.empty()) continue;
        print_scene(*task);
        code = std::max(code, work_on(*task));
        if (decided(team_, interrupted_ || records_->file().failed())) break;
    }
    return decided(team_, end(code));
}

int run(const RunOptions& options, RankTeam* team) {
    const RunGroups all(options, team);
    return options.dry_run ? list_cells(all, options, team) : Run(all, options, team).go();
}

} // namespace

/// Under MPI, all ranks measure each cell together, one cell after another.
int run_command(const RunOptions& options) {
    auto* ranks = job_ranks();
    if (ranks == nullptr) {
        if (options.shard.of == 1) warn_tasks_are_no_ranks();
        return run(options, nullptr);
    }
    RankTeam team(*ranks);
    auto own = options;
    team.together([&] {
        refuse_what_ranks_cannot(options);
        own.request.devices = {team.own_device(options)};
    });
    return run(own, &team);
}

} // namespace tandem
