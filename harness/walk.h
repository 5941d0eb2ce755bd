// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/broad/broad.h"
#include "harness/plan.h"

#include <array>

namespace tandem {

/// A session with the broad phase that its settings ask for; `scene` must outlive it.
struct Walk {
    Walk(const Cell& cell, const Scene& scene)
        : session(cell.algorithm->prepare(std::array{cell.device}, scene, cell.settings)) {
        if (!session->finds_pairs())
            broad.emplace(scene, geometry_of(session->settings()), broad_bound(session->settings()));
    }

    FrameResult run(const Frame& frame) {
        return session->run(frame, broad ? broad->pairs(frame) : std::vector<BodyPair>{});
    }

    std::unique_ptr<Session> session;
    std::optional<Broad> broad; ///< none when the session finds body pairs on its device
};

} // namespace tandem
