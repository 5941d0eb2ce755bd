// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"

#include <functional>

namespace tandem::python {

/// A candidate of algorithm="auto" that was timed.
struct Trial {
    std::string algorithm;
    SettingTexts changes; ///< settings that are not as its preset has them
    double seconds = 0;   ///< median of its frames
};

/// The fastest of several cells, prepared, and all that were timed, the fastest first.
struct Choosing {
    std::unique_ptr<Session> session;
    const Traversal* algorithm = nullptr;
    std::vector<Trial> trials;
};

/// Times the candidates with `frame`, which runs one, for as many seconds of frames, and six times as many of
/// preparing. Throws InputError with the first one's sentence where all fail.
Choosing choose(std::span<const Cell> candidates, const Scene& scene,
                const std::function<FrameResult(Session&)>& frame, double seconds);

} // namespace tandem::python
