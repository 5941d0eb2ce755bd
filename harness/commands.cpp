// SPDX-License-Identifier: MIT
#include "harness/commands.h"

#include "harness/dumps.h"
#include "harness/hard_truth.h"
#include "harness/inputs.h"
#include "harness/progress.h"
#include "harness/record.h"
#include "harness/table.h"
#include "harness/walk.h"
#include "scenes/error.h"
#include "scenes/hard/hard.h"

#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numeric>

namespace tandem {

namespace {

/// Everything that a command needs, found and checked before anything is measured or written.
struct Job {
    Scene scene;
    FrameRange range;
    std::vector<Cell> cells;
};

Job open_job(const RunOptions& options, const Request& request, const std::vector<BackendReport>& backends) {
    Job job;
    job.scene = open_scene(options);
    job.range = open_frames(options, job.scene);
    check_required(backends, options.require);
    job.cells = plan(request, choose_devices(backends, request.devices));
    check_outputs(options, job.cells);
    check_coordinates(job.cells, job.scene, job.range);
    return job;
}

void dump(const Cell& cell, const Job& job, DumpFile& pairs, DumpFile& contacts) {
    if (!pairs && !contacts) return;
    Walk walk(cell, job.scene);
    for (std::size_t i = 0; i < job.range.frames.size(); ++i) {
        const auto result = walk.run(job.range.frames[i]);
        if (pairs) pairs.pairs(job.range.first + i, walk.session->download(result));
        if (contacts) contacts.contacts(job.range.first + i, walk.session->download_contacts(result));
        cell.device->finish();
    }
}

/// Replays the frames and does nothing else, so that a profiler sees only the algorithm.
int profile(const Job& job, std::size_t times) {
    for (const auto& cell : job.cells) {
        Walk walk(cell, job.scene);
        for (std::size_t i = 0; i < times; ++i) {
            for (const auto& frame : job.range.frames) walk.run(frame);
            cell.device->finish();
        }
        fmt::print("{}: replayed frames {}:{} {} times; nothing measured or recorded\n", describe(cell),
                   job.range.first, job.range.last, times);
    }
    return 0;
}

std::string verdict(const Measurement& m) {
    const auto& a = m.agreement;
    if (a.frames == 0) return "not checked";
    if (a.ok())
        return fmt::format("right: {} pairs in {} frames, 0 missing, 0 extra, contacts equal", a.digest.count,
                           a.frames);
    return fmt::format("WRONG: {} missing, {} extra, contacts differ in {} of {} frames", a.missing, a.extra,
                       a.contact_frames_wrong, a.frames);
}

/// Measures one cell and appends its record, also when the device fails on the way.
int run_cell(const Cell& cell, const Job& job, References& references, const SampleOptions& sampling,
             RecordFile& file, const Progress& progress, Measurement& out) {
    std::string failure;
    try {
        out = measure(cell, job.scene, job.range, references, sampling);
    } catch (const DeviceError& error) {
        failure = error.what();
    }
    file.append(make_record(cell, job.scene, job.range, out, failure));
    progress.clear();
    if (failure.empty()) return out.agreement.ok() ? 0 : 1;
    fmt::print(stderr, "tandem: {}: {}\n", describe(cell), failure);
    return 3;
}

void print_scene(const Scene& scene, const FrameRange& range) {
    fmt::print("scene {}: {} bodies, {} vertices, {} tetrahedra, frames {}:{}, digest {:016x}\n", scene.key,
               scene.bodies.size(), vertex_count(scene), tetrahedron_count(scene), range.first, range.last,
               scene.digest);
    std::size_t inverted = 0;
    std::size_t degenerate = 0;
    for (const auto& mesh : scene.meshes) {
        inverted += mesh.inverted;
        degenerate += mesh.degenerate;
    }
    if (inverted + degenerate > 0)
        fmt::print("its meshes have {} inverted and {} zero-volume tetrahedra; they are kept\n", inverted,
                   degenerate);
}

void print_matrix_row(const Cell& cell, const Measurement& m) {
    fmt::print("{:<10} {:<12} {:<18} {:>10} {:>9} {:>8} {:>6} {:>9} {}\n", cell.device->info().id,
               cell.algorithm->name(), cell.preset, m.agreement.digest.count, m.agreement.missing,
               m.agreement.extra, m.retries,
               std::accumulate(m.contacts.begin(), m.contacts.end(), std::uint64_t{0}),
               m.agreement.contact_frames_wrong == 0 ? "yes" : "NO");
}

/// Checks every cell; `print` is given each that finished. Returns the exit code.
int check_cells(const Job& job, References& references, RecordFile& file, const Progress& progress,
                const std::function<void(const Cell&, const Measurement&)>& print) {
    SampleOptions sampling;
    sampling.repeat = 0;
    sampling.progress = [&](std::string_view text) { progress.show(text); };
    int code = 0;
    for (const auto& cell : job.cells) {
        Measurement m;
        const int own = run_cell(cell, job, references, sampling, file, progress, m);
        code = std::max(code, own);
        if (own != 3) print(cell, m);
    }
    return code;
}

/// One family of hard:all, on one line.
int check_family(const Job& job, RecordFile& file, const Progress& progress) {
    References references(job.scene, job.range);
    std::uint64_t wrong = 0;
    const int code = check_cells(job, references, file, progress, [&](const Cell&, const Measurement& m) {
        wrong += m.agreement.ok() ? 0 : 1;
    });
    const auto misses = count_misses(job.scene, job.range, job.cells, references);
    fmt::print("{:<26} {:>6} {:>9} {:>11} {:>7} {:>8} {:>6} {:>10}\n", job.scene.name,
               job.range.frames.size(), misses.touching, misses.overlapping, misses.safe, misses.nearest,
               job.cells.size(), wrong);
    return misses.safe == 0 ? code : std::max(code, 1);
}

/// `tandem check hard:all`: cells against the reference, and the reference against the exact truth.
int check_hard(const RunOptions& options, const Request& request, const std::vector<BackendReport>& backends,
               const std::vector<std::string>& scenes) {
    RecordFile file(options.out);
    const Progress progress(options.quiet);
    fmt::print("{:<26} {:>6} {:>9} {:>11} {:>7} {:>8} {:>6} {:>10}\n", "family", "frames", "touching",
               "overlapping", "missed", "nearest", "cells", "that differ");
    int code = 0;
    for (const auto& scene : scenes) {
        auto one = options;
        one.scene = scene;
        std::string refusal;
        try {
            code = std::max(code, check_family(open_job(one, request, backends), file, progress));
        } catch (const InputError& error) {
            refusal = error.what();
        }
        const bool invalid = scene.starts_with("hard:not-finite");
        if (invalid && refusal.empty()) code = std::max(code, 1);
        if (!refusal.empty() && !invalid) throw InputError(refusal);
        if (invalid)
            fmt::print("{:<26} {}\n", "hard:not-finite",
                       refusal.empty() ? "NOT refused" : "refused: " + refusal);
    }
    fmt::print("{}\n", code == 0 ? "all agree with the reference; with rounding=safe it misses nothing"
                                 : "NOT all agree with the reference and the truth");
    return code;
}

} // namespace

int run_command(const RunOptions& options) {
    auto request = options.request;
    if (request.devices.empty()) request.devices.emplace_back("opencl:0");
    const auto backends = discover();
    const auto job = open_job(options, request, backends);
    RecordFile file(options.out);
    DumpFile pairs(options.dump_pairs, pairs_header);
    DumpFile contacts(options.dump_contacts, contacts_header);
    print_scene(job.scene, job.range);
    if (options.profile > 0) return profile(job, options.profile);
    References references(job.scene, job.range);
    const Progress progress(options.quiet);
    SampleOptions sampling;
    sampling.repeat = options.repeat;
    sampling.check = options.check;
    sampling.count_work = options.count;
    std::deque<Measurement> measurements;
    std::vector<Row> rows;
    int code = 0;
    for (std::size_t i = 0; i < job.cells.size(); ++i) {
        sampling.progress = [&](std::string_view text) {
            progress.show(fmt::format("[{}/{}] {}", i + 1, job.cells.size(), text));
        };
        auto& measurement = measurements.emplace_back();
        const int own = run_cell(job.cells[i], job, references, sampling, file, progress, measurement);
        code = std::max(code, own);
        if (own != 3) rows.push_back({&job.cells[i], &measurement});
    }
    if (!rows.empty()) {
        dump(*rows.front().cell, job, pairs, contacts);
        fmt::print("\n{}\n{}\n", stage_table(rows), speedup_table(rows));
    }
    for (const auto& row : rows) fmt::print("{}: {}\n", describe(*row.cell), verdict(*row.measurement));
    if (!options.out.empty()) fmt::print("{} records appended to {}\n", job.cells.size(), options.out);
    return code;
}

int check_command(const RunOptions& options) {
    auto request = options.request;
    if (request.devices.empty()) request.devices.emplace_back("all");
    const auto backends = discover();
    const auto scenes = expand_hard(options.scene);
    if (scenes.size() > 1) return check_hard(options, request, backends, scenes);
    if (request.presets.empty()) request.presets.emplace_back("all");
    const auto job = open_job(options, request, backends);
    RecordFile file(options.out);
    print_scene(job.scene, job.range);
    References references(job.scene, job.range);
    const Progress progress(options.quiet);
    fmt::print("{:<10} {:<12} {:<18} {:>10} {:>9} {:>8} {:>6} {:>9} {}\n", "device", "algorithm", "preset",
               "pairs", "missing", "extra", "retry", "contacts", "contacts equal");
    int code = check_cells(job, references, file, progress, print_matrix_row);
    fmt::print("{}\n", code == 0 ? "all agree with the reference" : "NOT all agree with the reference");
    if (!options.scene.starts_with("hard:")) return code;
    const auto misses = count_misses(job.scene, job.range, job.cells, references);
    fmt::print("of {} touching and {} overlapping pairs {} are missed with rounding=safe, {} with nearest\n",
               misses.touching, misses.overlapping, misses.safe, misses.nearest);
    return misses.safe == 0 ? code : std::max(code, 1);
}

} // namespace tandem
