// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plan.h"
#include "harness/sampler.h"

namespace tandem {

/// What meets in the frames of a scene, and what candidate pairs miss of it.
struct Misses {
    std::uint64_t touching = 0, overlapping = 0; ///< pairs that meet, by the oracle
    std::uint64_t safe = 0;                      ///< missed in geometries with rounding=safe
    std::uint64_t nearest = 0;                   ///< in those with rounding=nearest, which may miss
};

/// Compares the reference's answer in every geometry of the cells with the exact truth of the cell's own
/// vertices: misses of a cell that agrees with the reference are the reference's.
Misses count_misses(const Scene& scene, const FrameRange& range, std::span<const Cell> cells,
                    References& references);

} // namespace tandem
