// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/body_pair.h"
#include "algorithms/hierarchy/chunk_trees.h"
#include "algorithms/published/conversion.h"

namespace tandem {

/// The trees of all bodies in the host's memory, as the paper's release keeps them: each chunk is a list of
/// its own. A node has the K slabs and 24 bytes of numbers, 56 bytes with k = 8 in float.
class HostTrees {
public:
    /// `trees` must outlive this object.
    explicit HostTrees(const ChunkTrees& trees);

    /// From the device's array of nodes.
    void store(std::span<const std::byte> nodes, Converter& converter);
    /// To an array of nodes for the device; what is in no chunk stays.
    void flatten(std::span<std::byte> nodes, Converter& converter) const;
    /// Copies the trees of both bodies of each pair twice, also those copied before, as the release does when
    /// it looks for their roots and when it flattens them. The copies are freed at once.
    void copy(std::span<const BodyPair> pairs, Converter& converter) const;

private:
    struct Chunk {
        std::uint64_t root = 0;         ///< slot of its root in the device's array
        std::uint32_t count = 0;        ///< nodes in use, which follow each other there
        std::vector<std::byte> nodes{}; ///< as many as a perfect tree has
    };

    const ChunkTrees& trees_;
    std::size_t slabs_, node_; ///< bytes of a node's slabs, and of a node
    std::vector<std::vector<Chunk>> bodies_;
};

} // namespace tandem
