// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"

#include <functional>

namespace tandem::python {

/// A timed candidate of algorithm="auto".
struct Trial {
    std::string algorithm;
    SettingTexts changes; ///< settings that differ from its preset
    double seconds = 0;   ///< median time of a frame
};

/// A prepared session of the fastest candidate, and all timed candidates, the fastest first.
struct Choosing {
    std::unique_ptr<Session> session;
    const Traversal* algorithm = nullptr;
    std::vector<Trial> trials;
};

/// Times the candidates for `seconds` of frames, plus at most six times as long for preparation. `frame` runs
/// one frame of a session. Throws InputError with the first error message if all candidates fail.
Choosing choose(std::span<const Cell> candidates, const Scene& scene,
                const std::function<FrameResult(Session&)>& frame, double seconds);

} // namespace tandem::python
