// SPDX-License-Identifier: MIT
// `tandem profile`.
#include "base/counted.h"
#include "harness/plans/cell_session.h"
#include "harness/record/record.h"
#include "harness/record/journal.h"
#include "harness/sampling/rounds.h"
#include "base/progress.h"
#include "harness/profile/ceilings.h"
#include "harness/profile/command.h"
#include "harness/program/cache_folder.h"
#include "harness/plans/cell_filter.h"
#include "harness/plans/inputs.h"
#include "harness/program/interrupt.h"
#include "harness/plans/task.h"
#include "harness/profile/output.h"
#include "harness/sampling/local_sampler.h"
#include "base/standard_streams.h"
#include "harness/profile/timeline/trace_frame.h"
#include "base/error.h"

#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <random>

namespace tandem {

namespace {

/// Frames with more pairs are not examined: sorting them takes long, and each pair takes 16 bytes.
constexpr std::uint64_t most_examined_pairs = std::uint64_t{1} << 27;

/// Counts the data that the candidate pairs of the mean frame touch, in a separate replay. After a signal it
/// counts none, so that the bounds are lower.
void count_touched(profile::Profile& profile, const Cell& cell, const Task& task, const Measurement& m) {
    if (Interrupt::asked() || m.candidate_pairs.empty() || !has_pairs(m.settings[parameters::output])
        || *std::ranges::max_element(m.candidate_pairs) > most_examined_pairs)
        return;
    auto& facts = profile.facts;
    try {
        Replays replays(cell, task.scene, task.range, Interrupt::asked);
        replays.timed([&](std::size_t, const FrameResult& result) {
            add_touched(facts, task.scene, m.settings, result.download());
        });
    } catch (const Interrupted&) {
        facts.touched = facts.touched_rows = facts.touched_vertices = 0;
    }
    const auto frames = static_cast<double>(task.range.size());
    for (auto* sum : {&facts.touched, &facts.touched_rows, &facts.touched_vertices}) *sum /= frames;
}

/// Measures the ceilings without the memory limit, which is meant for cells.
nlohmann::ordered_json measured_ceilings(Device& device) {
    const auto limit = device.memory_limit();
    device.set_memory_limit(Device::no_memory_limit);
    auto record = ceilings_record(device, measure_ceilings(device));
    device.set_memory_limit(limit);
    return record;
}

/// Profiles every cell of a task.
class Profiling {
public:
    explicit Profiling(const ProfileOptions& options);
    int go();

private:
    void refuse_unpreparable() const;
    void find_ceilings();
    void end(const Outcome& outcome, const Sampling& sampling);
    void print(const Cell& cell, const Measurement& m, const profile::Profile& profile) const;

    const ProfileOptions& options_;
    const RunOptions& run_;
    std::vector<BackendReport> backends_;
    std::optional<Task> task_;
    Progress progress_;
    std::map<const Device*, nlohmann::ordered_json> ceilings_;
    std::optional<RecordFile> file_;
    std::optional<TimelineFile> trace_;
    const Cell* traced_ = nullptr; ///< the first that finished
    int code_ = 0;
};

Profiling::Profiling(const ProfileOptions& options)
    : options_(options), run_(options.run), progress_(run_.quiet) {
    auto request = run_.request;
    if (request.devices.empty()) request.devices.emplace_back(default_device);
    backends_ = open_named(request.devices, run_.require);
    auto cells = plan(request, open_devices(run_, backends_, request.devices));
    drop_repeated(cells);
    keep_matching(cells, run_.filter);
    for (const auto& cell : cells)
        if (cell.devices.size() > 1)
            throw InputError(
                fmt::format("{}: a profile needs one device; name devices separately, D,E", describe(cell)));
    task_.emplace(open_scene(run_), run_, std::move(cells));
}

/// Throws the error of the first cell when no cell can be prepared, as with a capacity that exceeds the
/// memory: measuring ceilings takes a minute on a processor.
void Profiling::refuse_unpreparable() const {
    std::optional<DeviceError> first;
    for (const auto& cell : task_->cells) try {
            prepare_session(cell, task_->scene);
            return;
        } catch (const DeviceError& error) {
            if (!first) first = error;
        }
    if (first) throw DeviceError(*first);
}

/// Called before cells are measured, so that a file without ceilings is reported early.
void Profiling::find_ceilings() {
    for (const auto& cell : task_->cells) {
        auto* device = cell.devices.front();
        if (ceilings_.contains(device)) continue;
        progress_.show(fmt::format("ceilings of {}", device->info().id));
        auto& ceilings = ceilings_[device];
        if (options_.ceilings.empty()) {
            ceilings = measured_ceilings(*device);
        } else {
            ceilings = profile::read_ceilings(options_.ceilings, device->info());
            profile::check_clock(options_.ceilings, ceilings, *device);
        }
        progress_.clear();
    }
}

void Profiling::print(const Cell& cell, const Measurement& m, const profile::Profile& profile) const {
    const auto& a = m.agreement;
    const auto frames = static_cast<double>(m.breakdowns.back().frame_ns.size());
    double device = 0;
    for (const auto& kernel : profile.kernels) device += kernel.ns.median;
    put("\n{}\n{:.4g} us per frame; {:.4g} us in kernels when each is timed alone\n\n", describe(cell),
        median_ns(m) * 1e-3 / frames, device * 1e-3);
    put_text(profile_table(profile, options_.all));
    put("answer: {}\n", a.frames == 0 ? "not checked" : (a.ok() ? "right" : "WRONG"));
}

/// Ends a cell that needs no more rounds, or has failed: prints and records its profile.
void Profiling::end(const Outcome& outcome, const Sampling& sampling) {
    progress_.clear();
    const auto& cell = outcome.sampler->cell();
    const auto& m = outcome.sampler->measurement();
    const bool measured = outcome.failure.empty();
    if (!measured) print_message("tandem: {}: {}\n", describe(cell), outcome.failure);
    profile::Profile profile;
    const auto& ceilings = ceilings_.at(cell.devices.front());
    const auto& settings = m.settings.empty() ? cell.settings : m.settings;
    profile.ceilings = &ceilings;
    profile.ceilings_from = options_.ceilings.empty() ? "measured" : options_.ceilings;
    profile.limits = profile::limits_of(ceilings, static_cast<int>(settings[parameters::k]));
    profile.facts = mean_frame(m);
    if (measured && !m.breakdowns.empty()) {
        count_touched(profile, cell, *task_, m);
        profile.kernels =
            profile_kernels(m, profile.facts, cell.algorithm->costs(task_->scene, settings), profile.limits);
        print(cell, m, profile);
        if (traced_ == nullptr) traced_ = &cell;
    }
    const auto record = make_record(cell, task_->scene, task_->range, m, outcome, sampling);
    const bool recorded = file_->append_or_report(profile_record(record, profile));
    code_ = std::max(code_, !measured || !recorded ? 3 : (m.agreement.ok() ? 0 : 1));
}

int Profiling::go() {
    file_.emplace(run_.out);
    trace_.emplace(run_.trace);
    print_scene(*task_);
    refuse_unpreparable();
    report_cache_folder();
    find_ceilings();
    const Interrupt interrupt(Interrupt::stopping);
    References references(task_->scene, task_->range, checks_folder(run_));
    std::deque<LocalSampler> samplers;
    std::vector<CellSampler*> group;
    for (const auto& cell : task_->cells)
        group.push_back(&samplers.emplace_back(cell, task_->scene, task_->range, references));
    RoundsListener listener;
    listener.progress = [&](std::string_view text, std::optional<double> left) {
        progress_.show(text, left);
    };
    listener.stop = [&] { return file_->failed() || Interrupt::asked(); };
    listener.finished = [&](const Outcome& outcome, const Sampling& sampling) { end(outcome, sampling); };
    const CheckOptions check{run_.check, true, nullptr};
    const bool interrupted = sample_group(group, check, {run_.repeat, run_.noise, run_.seconds},
                                          run_.seed ? *run_.seed : std::random_device{}(), listener);
    if (traced_ != nullptr && *trace_ && !file_->failed() && !interrupted)
        trace_->write(trace_frame(*traced_, *task_));
    if (traced_ != nullptr) put_text("\n" + profile::profile_legend());
    if (!run_.out.empty()) put("{} appended to {}\n", counted(file_->appended(), "record"), run_.out);
    return interrupted && !file_->failed() ? Interrupt::exit_code() : code_;
}

} // namespace

int profile_command(const ProfileOptions& options) { return Profiling(options).go(); }

} // namespace tandem
