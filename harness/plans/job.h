// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands/commands.h"
#include "harness/record/journal.h"
#include "harness/commands/progress.h"
#include "harness/record/record.h"
#include "harness/sampling/rounds.h"
#include "harness/record/unfinished.h"

namespace tandem {

/// What is measured: a scene's frames and cells; the devices belong to whoever found them. It stays in its
/// place, since its frames are made of its scene.
struct Job {
    /// Opens the frames and handles their flaws; throws InputError when they, the outputs or the cells do not
    /// fit each other; cells that the scene does not fit are `unfit`.
    Job(Scene opened, const RunOptions& given, std::vector<Cell> planned, const Unfit& unfit = refuse);
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;

    RunOptions options; ///< with this scene and its frames
    Scene scene;
    FrameRange range;
    std::vector<Cell> cells;
};

/// Of the scene that the options name, which it opens; throws as the job's constructor.
Job open_job(const RunOptions& options, std::vector<Cell> cells, const Unfit& unfit = refuse);

/// How the cells of a job are measured.
struct Measuring {
    CheckOptions check;
    StoppingCriterion stopping;
    std::uint64_t seed = 0;
    Unfinished* unfinished = nullptr; ///< where rounds are kept; null: nowhere
    std::function<bool()> stop = [] { return false; };
};

/// What became of a cell.
struct CellResult {
    const Cell* cell = nullptr;
    Measurement measurement;
    int code = 0; ///< 0 right, 1 the answer is wrong, 3 the device failed or the record was not written
    bool measured = false;  ///< also without a record
    bool converged = false; ///< or sampled as often as asked for
};

/// Measures cells of the job as one group, appends a record for each as it ends, also when its device failed,
/// which is then said, and hands it over. A record that cannot be written ends it. Returns whether it was
/// interrupted: cells that had not begun then have no record.
bool measure_cells(const Job& job, std::span<const Cell> cells, References& references,
                   const Measuring& measuring, RecordFile& file, const Progress& progress,
                   const std::function<void(const CellResult&)>& ended);

/// Where digests of references and errors against the truth are kept; empty with --check-afresh.
std::filesystem::path checks_folder(const RunOptions& options);

/// A line that says what scene it is, one for tetrahedra of negative volume and one for flawed ones.
std::string scene_text(const Scene& scene, const FrameRange& range);
void print_scene(const Scene& scene, const FrameRange& range);

/// Safe and directed bounds miss nothing that meets (theorems of algorithms/bounds); the others promise
/// nothing.
bool misses_against_its_promise(const Measurement& m);

} // namespace tandem
