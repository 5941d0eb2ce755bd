// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/levels.h"

namespace tandem {

/// Nodes to rebuild when a frame skips tetrahedra, in the layout of kernel empty_nodes.
struct MaskedElements {
    std::vector<std::uint32_t> rows; ///< 3 words each: a node's slot and the slots of its two children
    std::vector<std::uint32_t>
        starts; ///< [body * rounds + round]: first row; the last entry is the number of rows
    std::uint32_t rounds = 0;
    std::uint32_t bodies = 0; ///< number of bodies with skipped tetrahedra
};

/// Collects the rows body by body: the leaves of skipped tetrahedra, then their ancestors bottom up. It
/// repeats this in each level below `end` for the changed chunk roots. refit_tops handles the levels from
/// `end` on.
class MaskedElementsPlan {
public:
    MaskedElementsPlan(std::uint32_t leaves, std::uint32_t end) : leaves_(leaves), end_(end) {}

    /// Adds a body with at least one skipped tetrahedron. `first_slot` is its first node slot; `items` are
    /// the positions of its skipped tetrahedra in the builder's order.
    void add(std::uint32_t first_slot, std::span<const Level> levels, std::vector<std::uint32_t> items);
    /// Returns the collected rows and completes their starts.
    MaskedElements take();

private:
    std::vector<std::uint32_t> add_level(std::uint32_t first_slot, std::span<const Level> levels,
                                         std::uint32_t index, std::span<const std::uint32_t> items);
    /// Starts a round. Its nodes depend only on nodes of earlier rounds.
    void begin_round();

    std::uint32_t leaves_, end_;
    MaskedElements result_;
};

} // namespace tandem
