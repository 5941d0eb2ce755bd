// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands.h"
#include "harness/journal.h"
#include "harness/progress.h"

namespace tandem {

/// What is measured: a scene's frames and cells; the devices belong to whoever found them.
struct Job {
    Scene scene;
    FrameRange range;
    std::vector<Cell> cells;
};

/// Opens the scene and its frames and handles their flaws; throws InputError when they, the outputs or the
/// cells do not fit each other.
Job open_job(const RunOptions& options, std::vector<Cell> cells);
Job open_job(Scene scene, const RunOptions& options, std::vector<Cell> cells);

/// What became of a cell.
struct CellResult {
    int code = 0; ///< 0 right, 1 the answer is wrong, 3 the device failed or the record was not written
    bool measured = false; ///< also without a record
};

/// Measures one cell and appends its record, also when the device fails on the way. What fails is said; after
/// a record that could not be written (file.failed()) no other cell should be measured.
CellResult run_cell(const Cell& cell, const Job& job, References& references, const SampleOptions& sampling,
                    RecordFile& file, const Progress& progress, Measurement& out);

/// A line that says what scene it is, one for tetrahedra of negative volume and one for flawed ones.
void print_scene(const Scene& scene, const FrameRange& range);

/// Safe and directed bounds miss nothing that meets (theorems of algorithms/bounds); the others promise
/// nothing.
bool misses_against_its_promise(const Measurement& m);

} // namespace tandem
