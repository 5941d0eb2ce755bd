// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/tile_trees.h"
#include "algorithms/pipeline/stages.h"
#include "backends/device.h"

namespace tandem {

/// The kernels of query.cu.
const KernelSource& cubql_kernels();

/// cuBQL's trees, one per body, over the leaf slabs that the project's own kernels make (k = 6: boxes).
/// Bodies with the same mesh have the same tree with other bounds.
class CubqlTrees final : public Hierarchy {
public:
    /// Builds a tree for each mesh from its vertices in the scene. Throws OutOfMemory or DeviceError.
    explicit CubqlTrees(const BuildContext& context);

    const Bodies& bodies() const { return tiles_.bodies(); }
    const Buffer& tree_nodes() const { return nodes_; } ///< cubql_trees::Node, one tree after the other
    const Buffer& tree_table() const { return table_; } ///< cubql_trees::TreeRow by body
    const Buffer& order() const { return order_; }      ///< tetrahedra by leaf, one mesh after the other
    const Buffer& boxes() const { return boxes_; }      ///< cubql_trees::Box by slot

    /// Work-items of a group in all kernels of query.cu.
    static constexpr std::uint32_t group_size = 128;

private:
    void do_refit(const Frame& frame, bool all) override;
    const Buffer& do_volumes() const override { return tiles_.volumes(); }
    const Buffer& do_nodes() const override { return tiles_.nodes(); }
    std::size_t do_bytes() const override;

    void upload_trees(const BuildContext& context);
    Grid grid(std::uint32_t items) const;

    Device& device_;
    TileTrees tiles_;
    std::uint32_t groups_; ///< maximum of a launch
    std::uint32_t slot_count_ = 0;
    std::uint32_t node_count_ = 0;
    Buffer nodes_, parents_, node_bodies_, table_, order_, boxes_, ready_;
    Kernel copy_, refit_;
};

} // namespace tandem
