// SPDX-License-Identifier: MIT
#include "harness/commands.h"

#include "harness/choosing/choose.h"
#include "harness/dumps.h"
#include "harness/inputs.h"
#include "harness/job.h"
#include "harness/progress.h"
#include "harness/standard_streams.h"
#include "harness/table.h"
#include "scenes/error.h"
#include "scenes/hard/hard.h"

#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numeric>

namespace tandem {

namespace {

/// Writes what was asked for in a replay of its own: files take longer than frames.
void dump(const Cell& cell, const Job& job, DumpFile& pairs, DumpFile& contacts) {
    if (!pairs && !contacts) return;
    const auto session = cell.algorithm->prepare(cell.devices, job.scene, cell.settings);
    for (std::size_t i = 0; i < job.range.frames.size(); ++i) {
        const auto result = session->run(job.range.frames[i]);
        if (pairs) pairs.pairs(job.range.first + i, result.download());
        if (contacts) contacts.contacts(job.range.first + i, result.download_contacts());
    }
}

/// Replays the frames and does nothing else, so that a profiler sees only the algorithm.
int profile(const Job& job, std::size_t times) {
    for (const auto& cell : job.cells) {
        const auto session = cell.algorithm->prepare(cell.devices, job.scene, cell.settings);
        for (std::size_t i = 0; i < times; ++i)
            for (const auto& frame : job.range.frames) session->run(frame);
        put("{}: replayed frames {}:{} {} times; nothing measured or recorded\n", describe(cell),
            job.range.first, job.range.last, times);
    }
    return 0;
}

/// Decides the cells of auto.
void choose_cells(Job& job, const RunOptions& options, const Progress& progress) {
    ChoosingOptions choosing;
    choosing.seconds = options.choose_seconds;
    choosing.afresh = options.choose_afresh;
    for (std::size_t i = 0; i < job.cells.size(); ++i) {
        choosing.progress = [&](std::string_view text) {
            progress.show(text.empty() ? "" : fmt::format("[{}/{}] {}", i + 1, job.cells.size(), text));
        };
        choose(job.cells[i], job.scene, job.range, choosing);
    }
}

std::string truth_of(const AnswerErrors& e) {
    return fmt::format("truth: {} of {} meeting pairs missed, {} candidates do not meet", e.missed(),
                       e.meeting(), e.pairs.disjoint);
}

/// The last line of a cell: right, or by how much not.
std::string verdict(const Measurement& m) {
    const auto& a = m.agreement;
    if (a.frames == 0) return "not checked";
    if (a.ok())
        return fmt::format("right: {} pairs in {} frames, 0 missing, 0 extra, contacts equal{}",
                           a.digest.count, a.frames, m.errors ? "; " + truth_of(*m.errors) : "");
    return fmt::format("WRONG: {} missing, {} extra, contacts differ in {} of {} frames", a.missing, a.extra,
                       a.contact_frames_wrong, a.frames);
}

} // namespace

int run_command(const RunOptions& options) {
    auto request = options.request;
    if (request.devices.empty()) request.devices.emplace_back("opencl:0");
    request.may_choose = true;
    const auto backends = discover();
    check_required(backends, options.require);
    auto job = open_job(options, plan(request, open_devices(options, backends, request.devices)));
    RecordFile file(options.out);
    DumpFile pairs(options.dump_pairs, pairs_header);
    DumpFile contacts(options.dump_contacts, contacts_header);
    print_scene(job.scene, job.range);
    const Progress progress(options.quiet);
    choose_cells(job, options, progress);
    if (options.profile > 0) return profile(job, options.profile);
    References references(job.scene, job.range);
    SampleOptions sampling;
    sampling.repeat = options.repeat;
    sampling.check = options.check;
    sampling.count_work = options.count;
    Truths truths(job.scene, job.range.frames, options.truth, options.truth_contacts);
    if (options.truth != TruthAmount::none) sampling.truths = &truths;
    std::deque<Measurement> measurements;
    std::vector<Row> rows;
    int code = 0;
    for (std::size_t i = 0; i < job.cells.size(); ++i) {
        sampling.progress = [&](std::string_view text) {
            progress.show(fmt::format("[{}/{}] {}", i + 1, job.cells.size(), text));
        };
        auto& measurement = measurements.emplace_back();
        const auto result = run_cell(job.cells[i], job, references, sampling, file, progress, measurement);
        code = std::max(code, result.code);
        if (result.measured) rows.push_back({&job.cells[i], &measurement});
        if (file.failed()) break;
    }
    if (!rows.empty()) put("\n{}\n{}\n", stage_table(rows), speedup_table(rows));
    for (const auto& row : rows) put("{}: {}\n", describe(*row.cell), verdict(*row.measurement));
    if (!options.out.empty()) put("{} records appended to {}\n", file.appended(), options.out);
    // Last, for a file that cannot be written ends the run.
    if (!rows.empty() && !file.failed()) dump(*rows.front().cell, job, pairs, contacts);
    return code;
}

} // namespace tandem
