// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/chunk_trees.h"
#include "scenes/contact.h"

#include <span>
#include <vector>

namespace tandem {

/// Tests an explicit list of tetrahedron pairs of a scene on its device, with the nodes and the overlap tests
/// of the walks: what these would find of the list if it were all they met.
class PairList {
public:
    /// `pairs` in input order; at most 2^32 - 1. Both must outlive this.
    PairList(const ChunkTrees& trees, std::span<const Pair> pairs);

    /// Whether the pairs are found, one byte a pair, in the frame that was last refitted: 1 when the leaf
    /// k-DOPs overlap by both forms of the test and so do all nodes above them that a walk may look at.
    /// Throws DeviceError.
    std::vector<std::uint8_t> run();

private:
    const ChunkTrees& trees_;
    std::uint32_t count_;
    Buffer pairs_, answers_;
    Kernel kernel_;
};

} // namespace tandem
