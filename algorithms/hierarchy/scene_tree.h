// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/chunk_trees.h"
#include "algorithms/hierarchy/radix_sort.h"
#include "algorithms/hierarchy/scene_bounds.cl.h"
#include "algorithms/hierarchy/scene_build.cl.h"

#include <optional>

namespace tandem {

/// One binary tree over the tetrahedra of all bodies, built on the device along a Morton curve
/// (scene_tree.clh). Leaves copy the bounds of trees over single bodies, which it also refits. Bounds follow
/// every frame; the tree is built anew every few frames, in a fixed sequence of launches.
class SceneTree final : public Hierarchy {
public:
    /// `period`: frames from a build to the next, at least 1. `self`: bodies that may be in pairs with
    /// themselves. `bodies` must outlive this object. Throws OutOfMemory, or DeviceError for 2^31 or more
    /// tetrahedra.
    SceneTree(const Bodies& bodies, LaunchShape shape, SelfPairs self, std::uint32_t period);

    /// Builds the tree in the next frame.
    void build_next() { builds_next_ = true; }

    const Bodies& bodies() const { return trees_.bodies(); }
    /// Defines for kernels that include scene_tree.clh.
    Defines defines(std::uint32_t group_size) const { return trees_.defines(group_size); }
    /// Leaves of the tree: tetrahedra of bodies with a role in the subdomain, if there is one.
    std::uint32_t count() const { return count_; }
    /// Whether the tree is of a subdomain.
    bool has_subdomain() const { return subdomain_.has_value(); }

    const Buffer& tree_table() const { return trees_.tree_table(); } ///< of the trees of bodies (node.clh)
    const Buffer& leaf_bounds() const { return leaf_bounds_; }       ///< K reals per leaf
    const Buffer& leaves() const { return leaves_; }                 ///< a row of 4 words per leaf
    const Buffer& inner() const { return inner_; }                   ///< the same per inner node
    const Buffer& inner_bounds() const { return inner_bounds_; }     ///< K reals per inner node
    const Buffer& state() const { return state_; }                   ///< STATE_WORDS words

private:
    /// A row of code_leaves in scene_build.cl.
    struct LeafRow {
        std::uint32_t bounds = 0, owner = 0, item = 0, unused = 0;
    };

    void do_refit(const Frame& frame, bool all) override;
    void do_take(const Subdomain& subdomain) override;
    const Buffer& do_volumes() const override { return trees_.volumes(); }
    const Buffer& do_nodes() const override { return trees_.nodes(); }
    std::size_t do_bytes() const override;

    bool is_passive(std::uint32_t body) const;
    void upload_rows();
    void build();
    void bound();
    Grid grid(std::uint64_t items) const;

    ChunkTrees trees_;
    Device& device_;
    LaunchShape shape_;
    SelfPairs self_;
    std::uint32_t period_;
    std::uint32_t count_ = 0;      ///< leaves
    std::uint32_t body_count_ = 0; ///< bodies with leaves
    bool builds_next_ = true;      ///< the next frame builds, whatever the period
    std::optional<Subdomain> subdomain_;
    std::optional<RadixSort> sort_;
    Buffer rows_, body_list_, region_, state_, leaves_, inner_, leaf_bounds_, inner_bounds_, boxes_,
        box_owners_;
    KernelOf<kernels::scene_build::BeginBuild> begin_;
    KernelOf<kernels::scene_build::CodeLeaves> code_;
    KernelOf<kernels::scene_build::LinkNodes> link_;
    KernelOf<kernels::scene_bounds::CopyLeafBounds> copy_;
    KernelOf<kernels::scene_bounds::BoundBoxes> boxes_kernel_;
    KernelOf<kernels::scene_bounds::BoundInnerNodes> inner_kernel_;
};

} // namespace tandem
