// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/run_options.h"
#include "harness/frames/frames.h"

namespace tandem {

/// The work of a measurement: a scene with its frames and cells. The caller owns the devices. A task cannot
/// move, because its frames refer to its scene.
struct Task {
    /// Opens the frames and handles their flaws. Throws InputError when frames, outputs and cells do not fit
    /// each other. Cells that do not fit the scene go to `unfit`.
    Task(Scene opened, const RunOptions& given, std::vector<Cell> planned, const Unfit& unfit = refuse);
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

    RunOptions options; ///< for this scene and its frames
    Scene scene;
    FrameRange range;
    std::vector<Cell> cells;
};

/// Opens the scene of the options and makes its task. Throws as the constructor of Task.
Task open_task(const RunOptions& options, std::vector<Cell> cells, const Unfit& unfit = refuse);

/// The folder for stored digests of references and errors against the truth; empty with --check-afresh.
std::filesystem::path checks_folder(const RunOptions& options);

/// One line that describes the scene, one for inverted tetrahedra and one for flawed ones, if there are any.
std::string scene_text(const Scene& scene, const FrameRange& range);
/// Prints it, and on standard error what is remarkable about its meshes, why nothing can meet in some of the
/// cells, and a line where cells do not count from the middle of a far scene.
void print_scene(const Task& task);

} // namespace tandem
