// SPDX-License-Identifier: MIT
#include "harness/commands/run.h"
#include "harness/measuring/measure.h"

#include "harness/program/cache_folder.h"
#include "harness/choosing/choose.h"
#include "harness/commands/dumps.h"
#include "harness/program/environment.h"
#include "harness/record/finished_cells.h"
#include "harness/plans/inputs.h"
#include "harness/program/interrupt.h"
#include "harness/plans/task.h"
#include "harness/plans/key.h"
#include "harness/plans/cell_groups.h"
#include "base/progress.h"
#include "harness/program/mpi_environment.h"
#include "harness/program/run_on_ranks.h"
#include "harness/plans/cell_session.h"
#include "harness/plans/rank_team.h"
#include "harness/commands/run_parts.h"
#include "harness/sampling/replays.h"
#include "base/standard_streams.h"
#include "harness/profile/timeline/trace_frame.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>

namespace tandem {

namespace {

/// Writes the dumps in a separate replay, because writing files takes longer than running frames. Throws
/// Interrupted.
void dump(const Cell& cell, const Task& task, DumpFile& pairs, DumpFile& contacts) {
    if (task.options.dump_pairs.empty() && task.options.dump_contacts.empty()) return;
    const auto session = prepare_session(cell, task.scene);
    for (std::size_t i = 0; i < task.range.size(); ++i) {
        if (decided(cell.team, Interrupt::asked())) throw Interrupted();
        const auto state = task.range.state(i, session->settings()[parameters::motion]);
        const auto result = session->run(FrameView(state.input()).checked());
        // Collective: all ranks download; only rank 0 writes.
        if (!task.options.dump_pairs.empty())
            if (const auto found = result.download(); pairs) pairs.pairs(task.range.first() + i, found);
        if (!task.options.dump_contacts.empty())
            if (const auto found = result.download_contacts(); contacts)
                contacts.contacts(task.range.first() + i, found);
    }
    pairs.finish();
    contacts.finish();
}

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

/// The keys of the cells of a task, in order.
std::string keys_of(const Task& task) {
    std::string keys;
    for (const auto& cell : task.cells) keys += key_of(cell, cell.settings, task.scene, task.range) + "\n";
    return keys;
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
    Run(const RunOptions& options, RankTeam* team);
    int go();

private:
    void check_one_group() const;
    std::unique_ptr<Task> open(const CellGroup& group, const Unfit& unfit) const;
    void open_files();
    int work_on(Task& task);
    int measure(Task& task);
    void conclude(const Task& task, const std::map<const Cell*, CellResult>& results);
    int end(int code);
    void leave_out_finished(Task& task);
    int list_all();
    void list(const Task& task);

    void open_team();
    bool must_stop() const;

    const RunOptions& options_;
    RankTeam* const team_; ///< null: one process
    std::vector<BackendReport> backends_;
    CellGroups all_;
    std::optional<RecordFile> file_;
    std::optional<DumpFile> pairs_, contacts_;
    std::optional<TimelineFile> trace_;
    FinishedCells finished_;
    Unfinished unfinished_;
    Progress progress_;
    std::size_t later_cells_ = 0; ///< of the groups after that which is measured
    std::size_t listed_ = 0, unknown_ = 0, measured_ = 0, left_out_ = 0, verdicts_ = 0;
    double seconds_ = 0;
    bool interrupted_ = false;
    bool dump_ended_ = false; ///< a signal ended the dump, which is not written
};

Run::Run(const RunOptions& options, RankTeam* team)
    : options_(options), team_(team), progress_(options.quiet) {
    together(team_, [&] {
        const auto plan = plan_of(options_);
        const auto names = devices_of(plan);
        backends_ = open_backends(names, options_.require);
        check_required(backends_, options_.require);
        limit_memory(options_, backends_);
        const auto choose = [&](const auto& asked) {
            if (team_ == nullptr || !asks_for_each(asked[0])) return choose_devices(backends_, asked);
            return choose_devices(backends_, std::array{team_->own_of_each(asked[0], backends_)});
        };
        all_ = make_groups(plan, choose, options_.shard);
        keep_matching(all_, options_.filter, options_.shard);
        print_left_out(all_);
        if (options_.shard.of > 1)
            put("shard {}/{}: {} of {} groups\n", options_.shard.index, options_.shard.of, all_.groups.size(),
                all_.numbered);
        check_one_group();
    });
    if (team_ != nullptr && !all_.groups.empty()) open_team();
}

/// Opens the team with the one device of this rank: all cells use the same.
void Run::open_team() {
    for (auto& group : all_.groups)
        for (auto& cell : group.cells) {
            cell.team = team_;
            for (auto& candidate : cell.candidates) candidate.team = team_;
        }
    team_->open(*all_.groups.front().cells.front().devices.front());
}

/// Dumps and traces are written for the first finished cell, so there must be only one group.
void Run::check_one_group() const {
    if (all_.groups.size() <= 1) return;
    if (!options_.dump_pairs.empty() || !options_.dump_contacts.empty())
        throw InputError("dumps need one scene and one range of its frames; name one of each");
    if (!options_.trace.empty())
        throw InputError("--trace needs one scene and one range of its frames; name one of each");
}

/// Called only after the input was checked, so that a mistake leaves no empty files behind.
void Run::open_files() {
    if (file_) return;
    together(team_, [&] {
        const bool writes = is_first(team_);
        const auto path = [&](const std::string& given) { return writes ? given : std::string(); };
        file_.emplace(path(options_.dry_run && !options_.resume ? std::string() : options_.out));
        if (options_.resume && writes) finished_ = FinishedCells(*file_, options_.out);
        if (options_.dry_run) return;
        if (writes) unfinished_ = Unfinished(options_.out, options_.resume);
        pairs_.emplace(path(options_.dump_pairs), pairs_header);
        contacts_.emplace(path(options_.dump_contacts), contacts_header);
        trace_.emplace(path(options_.trace));
    });
}

/// Whether there was an interrupt, or the record file cannot be written.
bool Run::must_stop() const { return decided(team_, interrupted_ || file_->failed()); }

void Run::leave_out_finished(Task& task) {
    left_out_ += std::erase_if(task.cells, [&](const Cell& cell) {
        if (!cell.candidates.empty()) return false;
        if (!decided(team_, finished_.has(cell, task.scene, task.range))) return false;
        unfinished_.forget(key_of(cell, cell.settings, task.scene, task.range));
        return true;
    });
}

/// Lists the cells with the keys of their records, and estimates their time: the earlier time where known,
/// else --seconds.
void Run::list(const Task& task) {
    for (const auto& cell : task.cells) {
        const auto known = finished_.seconds(cell, task.scene, task.range);
        if (!known && options_.repeat) ++unknown_;
        seconds_ += known ? *known : (options_.repeat ? 0 : options_.seconds);
        put("{:>5}  {}\n       {}\n", ++listed_, describe(cell),
            cell.candidates.empty() ? key_of(cell, session_settings(cell, task.scene), task.scene, task.range)
                                    : "its key is that of the choice");
    }
}

int Run::measure(Task& task) {
    Truths truths(task.scene, task.range, options_.truth, options_.truth_contacts, checks_folder(options_));
    auto measuring = measuring_of(options_);
    if (options_.truth != TruthAmount::none) measuring.check.truths = &truths;
    measuring.unfinished = &unfinished_;
    measuring.stop = Interrupt::asked;
    measuring.seed = decided(team_, measuring.seed);
    References references(task.scene, task.range, checks_folder(options_));
    std::map<const Cell*, CellResult> results;
    int code = 0;
    const auto ended = [&](const CellResult& result) {
        code = std::max(code, result.code);
        results.emplace(result.cell, result);
    };
    interrupted_ =
        measure_cells(task, task.cells, references, measuring, *file_, {progress_, ended, later_cells_});
    measured_ += results.size();
    conclude(task, results);
    if (interrupted_) return code;
    // Dumps come last, because a dump that cannot be written ends the run.
    for (const auto& cell : task.cells)
        if (const auto found = results.find(&cell); found != results.end() && found->second.measured) {
            const bool continues = !decided(team_, file_->failed());
            if (continues) try {
                    dump(cell, task, *pairs_, *contacts_);
                } catch (const Interrupted&) {
                    interrupted_ = dump_ended_ = true;
                    return code;
                }
            if (continues && !options_.trace.empty()) trace_->write(trace_frame(cell, task));
            break;
        }
    return code;
}

/// Prints the results and records the verdicts on them.
void Run::conclude(const Task& task, const std::map<const Cell*, CellResult>& results) {
    std::vector<const CellResult*> in_order;
    for (const auto& cell : task.cells)
        if (const auto found = results.find(&cell); found != results.end())
            in_order.push_back(&found->second);
    const auto rows = rows_of(task, in_order);
    const auto verdicts = verdicts_of(rows);
    print_results(rows, verdicts, task, in_order);
    if (interrupted_ || file_->failed() || !is_first(team_)) return;
    for (const auto& verdict : verdicts)
        verdicts_ += file_->append_or_report(verdict_record(verdict, rows, task.scene, task.range)) ? 1 : 0;
}

/// Prints the last messages and returns the exit code.
int Run::end(int code) {
    if (options_.profile > 0) return interrupted_ ? Interrupt::exit_code() : code;
    const bool lacks_dump =
        measured_ == 0 && !(options_.dump_pairs.empty() && options_.dump_contacts.empty());
    if (left_out_ > 0)
        put("{} cells are already in {}{}\n", left_out_, options_.out,
            lacks_dump ? "; no dump is written: run again without --resume" : "");
    if (!options_.out.empty())
        put("{} records appended to {}\n", file_->appended() - verdicts_, options_.out);
    if (!interrupted_ && !file_->failed()) unfinished_.remove();
    if (!interrupted_ || file_->failed()) return code;
    const bool can_resume = !options_.out.empty() && !dump_ended_;
    print_message("tandem: interrupted; {} cells are measured{}{}\n", measured_,
                  dump_ended_ ? "; the dump is not written: run again without --resume" : "",
                  can_resume
                      ? fmt::format("; to continue: {}{}", command_line(), options_.resume ? "" : " --resume")
                      : "");
    return Interrupt::exit_code();
}

std::unique_ptr<Task> Run::open(const CellGroup& group, const Unfit& unfit) const {
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
    if (options_.dry_run) return list_all();
    if (all_.groups.empty()) return 0;
    // Open all groups first, so that a mistake in the last scene is found before the first is measured.
    if (all_.groups.size() > 1)
        for (const auto& group : all_.groups) open(group, leave_out);
    report_cache_folder();
    const Interrupt interrupt(is_first(team_) ? Interrupt::stopping : std::string_view());
    int code = 0;
    for (const auto& group : all_.groups) later_cells_ += group.cells.size();
    for (const auto& group : all_.groups) {
        later_cells_ -= group.cells.size();
        const auto task = open(group, print_skipped);
        open_files();
        leave_out_finished(*task);
        if (task->cells.empty()) continue;
        print_scene(*task);
        code = std::max(code, work_on(*task));
        if (must_stop()) break;
    }
    return decided(team_, end(code));
}

/// --dry-run. A scene that cannot be opened yet, such as a missing recording, does not hide the other groups.
int Run::list_all() {
    std::size_t unopened = 0;
    for (const auto& group : all_.groups) try {
            const auto task = open(group, print_skipped);
            open_files();
            leave_out_finished(*task);
            print_scene(*task);
            list(*task);
        } catch (const InputError& error) {
            if (all_.groups.size() == 1) throw;
            print_message("tandem: {} cells cannot be listed: {}\n", group.cells.size(), error.what());
            ++unopened;
        }
    put("{} cells, about {:.0f} s of rounds{}{}; checks against the reference and the truth take extra "
        "time\n",
        listed_, seconds_, unknown_ > 0 ? fmt::format(" and {} cells of unknown duration", unknown_) : "",
        left_out_ > 0 ? fmt::format("; {} more are already in {}", left_out_, options_.out) : "");
    return unopened > 0 ? 2 : 0;
}

} // namespace

/// Under MPI, all ranks measure each cell together, one cell after another.
int run_command(const RunOptions& options) {
    auto* ranks = job_ranks();
    if (ranks == nullptr) {
        if (options.shard.of == 1) warn_tasks_are_no_ranks();
        return Run(options, nullptr).go();
    }
    RankTeam team(*ranks);
    auto own = options;
    team.together([&] {
        refuse_what_ranks_cannot(options);
        own.request.devices = {team.own_device(options)};
    });
    return Run(own, &team).go();
}

} // namespace tandem
