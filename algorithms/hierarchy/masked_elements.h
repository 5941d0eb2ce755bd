// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/levels.h"

namespace tandem {

/// Nodes to make again when some tetrahedra take no part, as kernel empty_nodes takes them.
struct MaskedElements {
    std::vector<std::uint32_t> rows;   ///< 3 words each: a node's slot, and those of the two it is over
    std::vector<std::uint32_t> starts; ///< [body * rounds + round]: first row; a last one for their number
    std::uint32_t rounds = 0;
    std::uint32_t bodies = 0; ///< that lack a tetrahedron
};

/// Collects them body by body: the leaves of skipped tetrahedra, their ancestors bottom up, the same in the
/// next level for the chunk roots that these change, and so on below level `end`, where refit_tops goes on.
class MaskedElementsPlan {
public:
    MaskedElementsPlan(std::uint32_t leaves, std::uint32_t end) : leaves_(leaves), end_(end) {}

    /// A body with its first node slot, its levels and its skipped tetrahedra, one at least; positions[t] is
    /// tetrahedron t's in Morton order.
    void add(std::uint32_t first_slot, std::span<const Level> levels, std::span<const std::uint32_t> skipped,
             std::span<const std::uint32_t> positions);
    /// What was collected, ended by the last start.
    MaskedElements take();

private:
    std::vector<std::uint32_t> add_level(std::uint32_t first_slot, std::span<const Level> levels,
                                         std::uint32_t index, std::span<const std::uint32_t> items);
    /// Nodes of one round depend on none of it, only on earlier ones.
    void begin_round();

    std::uint32_t leaves_, end_;
    MaskedElements result_;
};

} // namespace tandem
