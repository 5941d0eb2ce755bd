// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/run_options.h"
#include "harness/record/journal.h"
#include "base/progress.h"
#include "harness/record/record.h"
#include "harness/sampling/rounds.h"
#include "harness/record/unfinished.h"

namespace tandem {

/// The work of a measurement: a scene with its frames and cells. The caller owns the devices. A job cannot
/// move, because its frames refer to its scene.
struct Job {
    /// Opens the frames and handles their flaws. Throws InputError when frames, outputs and cells do not fit
    /// each other. Cells that do not fit the scene go to `unfit`.
    Job(Scene opened, const RunOptions& given, std::vector<Cell> planned, const Unfit& unfit = refuse);
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;

    RunOptions options; ///< for this scene and its frames
    Scene scene;
    FrameRange range;
    std::vector<Cell> cells;
};

/// Opens the scene of the options and makes its job. Throws as the constructor of Job.
Job open_job(const RunOptions& options, std::vector<Cell> cells, const Unfit& unfit = refuse);

/// How the cells of a job are measured.
struct Measuring {
    CheckOptions check;
    StoppingCriterion stopping;
    std::uint64_t seed = 0;
    Unfinished* unfinished = nullptr; ///< stores the rounds of unfinished cells; null: they are not stored
    std::function<void()> before_round = [] {};
    std::function<bool()> stop = [] { return false; };
};

/// The result of a cell.
struct CellResult {
    const Cell* cell = nullptr;
    Measurement measurement;
    int code = 0; ///< 0: right; 1: the answer is wrong; 3: the device failed or the record was not written
    bool measured = false;  ///< the device did not fail; the record may still be missing
    bool converged = false; ///< precise enough, or sampled as often as requested
};

/// How a measurement reports: `progress` shows what runs, `ended` takes each cell's result as it ends.
struct CellsListener {
    const Progress& progress;
    std::function<void(const CellResult&)> ended;
    std::size_t later_cells = 0; ///< cells that are measured afterwards, for the estimated time left
};

/// Measures the cells as one group. Appends a record for each cell as it ends, also when its device failed,
/// before the listener gets its result. Stops when a record cannot be written. Returns whether the
/// measurement was interrupted: then cells that had not begun have no record.
bool measure_cells(const Job& job, std::span<const Cell> cells, References& references,
                   const Measuring& measuring, RecordFile& file, const CellsListener& listener);

/// The folder for stored digests of references and errors against the truth; empty with --check-afresh.
std::filesystem::path checks_folder(const RunOptions& options);

/// One line that describes the scene, one for inverted tetrahedra and one for flawed ones, if there are any.
std::string scene_text(const Scene& scene, const FrameRange& range);
/// Prints it, and on standard error what is remarkable about its meshes, why nothing can meet in some of the
/// cells, and a line where cells do not count from the middle of a far scene.
void print_scene(const Job& job);

/// Whether a cell missed pairs although its rounding is safe or directed. These roundings miss no pair that
/// touches or overlaps (theorems of algorithms/bounds); other roundings guarantee nothing.
bool misses_against_its_promise(const Measurement& m);

} // namespace tandem
