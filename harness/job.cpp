// SPDX-License-Identifier: MIT
#include "harness/job.h"

#include "harness/inputs.h"
#include "harness/record.h"
#include "harness/standard_streams.h"
#include "scenes/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tandem {

Job open_job(const RunOptions& options, std::vector<Cell> cells) {
    return open_job(open_scene(options), options, std::move(cells));
}

Job open_job(Scene scene, const RunOptions& options, std::vector<Cell> cells) {
    Job job;
    job.scene = std::move(scene);
    job.range = open_frames(options, job.scene);
    job.range.flaws = handle_flaws(job.scene, job.range.first, job.range.frames, options.degenerate);
    job.cells = std::move(cells);
    check_outputs(options, job.cells);
    check_coordinates(job.cells, job.scene, job.range);
    return job;
}

/// A device that fails costs its own cell: the record says why, and the next cell goes on.
CellResult run_cell(const Cell& cell, const Job& job, References& references, const SampleOptions& sampling,
                    RecordFile& file, const Progress& progress, Measurement& out) {
    std::string failure;
    try {
        out = measure(cell, job.scene, job.range, references, sampling);
    } catch (const DeviceError& error) {
        failure = error.what();
    }
    progress.clear();
    const bool recorded = file.append_or_tell(make_record(cell, job.scene, job.range, out, failure));
    if (!failure.empty()) tell("tandem: {}: {}\n", describe(cell), failure);
    if (!failure.empty() || !recorded) return {3, failure.empty()};
    return {out.agreement.ok() ? 0 : 1, true};
}

void print_scene(const Scene& scene, const FrameRange& range) {
    put("scene {}: {} bodies, {} vertices, {} tetrahedra, frames {}:{}, digest {:016x}\n", scene.key,
        scene.bodies.size(), vertex_count(scene), tetrahedron_count(scene), range.first, range.last,
        scene.digest);
    std::size_t inverted = 0;
    for (const auto& mesh : scene.meshes) inverted += mesh.inverted;
    if (inverted > 0) put("its meshes have {} inverted tetrahedra; they are kept\n", inverted);
    if (range.flaws.any())
        put("tetrahedra {}; they {}\n", describe(range.flaws, scene),
            range.flaws.handling == Degenerate::skip ? "take no part" : "take part as flat sets");
}

bool misses_against_its_promise(const Measurement& m) {
    const auto rounding = m.settings[parameters::rounding];
    return m.errors && m.errors->missed() > 0
           && (rounding == Rounding::safe || rounding == Rounding::directed);
}

} // namespace tandem
