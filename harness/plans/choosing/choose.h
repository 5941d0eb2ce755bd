// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/choosing/choice_cache.h"
#include "harness/plans/frames.h"

#include <functional>

namespace tandem {

/// Frames that candidates are compared on, the first of those asked for.
inline constexpr std::size_t most_choosing_frames = 4;

struct ChoosingOptions {
    double seconds = 10; ///< of replays; preparing may take six times as long
    bool afresh = false; ///< look for no choice that was kept
    std::filesystem::path folder = ChoiceCache::default_folder();
    std::function<void(std::string_view)> progress = [](std::string_view) {}; ///< given "" at the end
};

/// Makes a cell with candidates the one that was kept, or else the fastest of them, which is then kept. Says
/// in one line on standard error which, and in one each what became of the file. Where every candidate
/// fails, the cell stays its first, whose measurement will say why.
void choose(Cell& cell, const Scene& scene, const FrameRange& range, const ChoosingOptions& options);

} // namespace tandem
