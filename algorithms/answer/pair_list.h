// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/chunk_trees.h"
#include "algorithms/answer/pair_list.cl.h"
#include "scenes/contact.h"

#include <span>
#include <vector>

namespace tandem {

/// Tests an explicit list of tetrahedron pairs of a scene on its device, with the nodes and the overlap tests
/// of the walks. The result is what a walk would find if it reached exactly these pairs.
class PairList {
public:
    /// `pairs`: of walked tetrahedra, in input order, at most 2^32 - 1. `trees` must outlive this object.
    PairList(const ChunkTrees& trees, std::span<const Pair> pairs);

    /// Returns one byte per pair, for the frame of the last refit. It is 1 if the leaf k-DOPs overlap by both
    /// forms of the test and so do all nodes above them that a walk may test. Throws DeviceError.
    std::vector<std::uint8_t> run();

private:
    const ChunkTrees& trees_;
    std::uint32_t count_;
    Buffer pairs_, answers_;
    KernelOf<kernels::pair_list::TestPairList> kernel_;
};

} // namespace tandem
