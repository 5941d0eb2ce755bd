// SPDX-License-Identifier: MIT
#include "harness/hard_truth.h"

#include "harness/oracle/frame_truth.h"

#include <algorithm>

namespace tandem {

namespace {

std::vector<Geometry> geometries_of(std::span<const Cell> cells) {
    std::vector<Geometry> result;
    for (const auto& cell : cells) {
        const auto geometry = geometry_of(cell.settings);
        if (std::find(result.begin(), result.end(), geometry) == result.end()) result.push_back(geometry);
    }
    return result;
}

} // namespace

Misses count_misses(const Scene& scene, const FrameRange& range, std::span<const Cell> cells,
                    References& references) {
    const auto geometries = geometries_of(cells);
    Misses misses;
    for (const auto precision : {Precision::single, Precision::twice}) {
        const auto wanted = [&](const Geometry& geometry) { return geometry.precision == precision; };
        if (std::none_of(geometries.begin(), geometries.end(), wanted)) continue;
        for (std::size_t i = 0; i < range.frames.size(); ++i) {
            const auto truth = frame_truth(scene, range.frames[i], precision);
            misses.touching += truth.touching.size();
            misses.overlapping += truth.overlapping.size();
            for (const auto& geometry : geometries) {
                if (!wanted(geometry)) continue;
                const auto errors = pair_errors(truth, references.answer(geometry, i).pairs);
                auto& missed = geometry.rounding == Rounding::safe ? misses.safe : misses.nearest;
                missed += errors.missed_touching + errors.missed_overlapping;
            }
        }
    }
    return misses;
}

} // namespace tandem
