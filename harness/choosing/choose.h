// SPDX-License-Identifier: MIT
#pragma once

#include "harness/program/cache_folder.h"
#include "harness/plans/cells.h"
#include "harness/frames/frames.h"

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// Maximum number of frames that candidates are compared on: the first of the range.
inline constexpr std::size_t most_choosing_frames = 4;

struct ChoosingOptions {
    double seconds = 10; ///< limit of the replays; preparation may take six times as long
    bool afresh = false; ///< ignore a stored choice
    std::function<bool()> stop = [] { return false; }; ///< before a frame: whether to end with Interrupted
    std::filesystem::path folder = cache_folder();     ///< of choices; empty: nothing is stored
    std::function<void(std::string_view)> progress = [](std::string_view) {}; ///< called with "" at the end
};

/// Collective with ranks: rank 0 reads and stores choices. Replaces a cell with candidates by the stored
/// choice, or else by the fastest candidate, which is then stored. Prints the choice on standard error in one
/// line, and one line for each problem with the file. When every candidate fails, the cell stays equal to the
/// first, and its measurement reports the failure.
void choose(Cell& cell, const Scene& scene, const FrameRange& range, const ChoosingOptions& options);

/// Everything that a choice depends on. Devices: models, drivers, memory limits. Scene: numbers of bodies,
/// tetrahedra and `pairs` (candidate pairs per frame) as powers of 4 rounded down (null: none), and whether
/// bodies are deformable. Candidates: a digest of all, which includes the settings that the user fixed.
nlohmann::ordered_json question_of(const Cell& cell, const Scene& scene, std::uint64_t pairs);

} // namespace tandem
