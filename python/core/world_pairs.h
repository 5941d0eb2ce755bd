// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/broad_phase/broad.h"

#include <vector>

namespace tandem::python {

/// Finds the body pairs of several worlds in one scene, each world by itself, on all cores: pairs of bodies
/// of two worlds are not even compared. The bodies of a world follow each other.
class WorldPairs {
public:
    /// `worlds` divides the number of bodies. `broad`: for Broad::device the host takes Broad::tight, which
    /// finds no fewer pairs. `scene` must outlive this.
    WorldPairs(const Scene& scene, const Geometry& geometry, Broad broad, SelfPairs self, std::size_t worlds);

    /// Those that BroadSweep finds within the worlds, ascending. Throws nothing for a checked frame.
    std::vector<BodyPair> pairs(const FrameInput& input) const;

private:
    std::vector<BodyPair> pairs_of(const FrameInput& input, std::uint32_t first) const;

    const Scene& scene_;
    BroadSweep sweep_;
    SelfPairs self_;
    std::size_t worlds_;
    std::uint32_t bodies_; ///< of a world
};

} // namespace tandem::python
