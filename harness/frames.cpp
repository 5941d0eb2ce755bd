// SPDX-License-Identifier: MIT
#include "harness/frames.h"

#include "scenes/error.h"

#include <fmt/format.h>

namespace tandem {

void check_frames(const Scene& scene, std::size_t first, std::size_t last) {
    if (first <= last && last < scene.frame_count) return;
    const auto wanted = fmt::format("frames {}:{} are impossible", first, last);
    if (first <= last && scene.dynamics)
        throw InputError(
            fmt::format("{}; scene {} moves by simulation and has its start only, frame 0: record it "
                        "with 'tandem simulate {} -o FILE.frames' and name FILE.frames",
                        wanted, scene.name, scene.name));
    if (first <= last && !scene.end.empty()) throw InputError(fmt::format("{}; {}", wanted, scene.end));
    throw InputError(fmt::format("{}; scene {} has frames 0:{}", wanted, scene.name, scene.frame_count - 1));
}

FrameRange make_frames(const Scene& scene, std::size_t first, std::size_t last) {
    check_frames(scene, first, last);
    FrameRange range{first, last, {}};
    for (auto i = first; i <= last; ++i) range.frames.push_back(scene.frame(i));
    return range;
}

} // namespace tandem
