// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/hierarchy/masked_elements.h"
#include "algorithms/hierarchy/hierarchy.h"
#include "algorithms/hierarchy/levels.h"
#include "algorithms/hierarchy/refit.cl.h"
#include "algorithms/hierarchy/strips.h"

namespace tandem {

/// Chunks over every body's tetrahedra and super chunks over the chunks (paper, section 3.1). The nodes are
/// k-DOPs in complete binary trees with implicit children (heap.clh).
class ChunkTrees final : public Hierarchy {
public:
    /// Tetrahedra of a chunk: more than a body can have, so that each body is one complete binary tree.
    static constexpr std::uint32_t one_chunk_a_body = std::uint32_t{1} << 30;

    /// `leaves`: tetrahedra per chunk, a power of two. `group_size`: maximum work-items of a work-group.
    /// `bodies` must outlive this object. Throws OutOfMemory when the nodes do not fit, DeviceError when
    /// there are 2^32 or more.
    ChunkTrees(const Bodies& bodies, std::uint32_t leaves, std::uint32_t group_size);

    const Bodies& bodies() const { return bodies_; }
    std::uint32_t group_size() const { return group_size_; }
    std::uint32_t leaves() const { return leaves_; }
    /// Levels of a body's hierarchy.
    const std::vector<Level>& levels(std::uint32_t body) const {
        return mesh_levels_[bodies_.scene().bodies[body].mesh];
    }
    /// The body's first node slot.
    std::uint32_t first_slot(std::size_t body) const { return trees_[body].nodes; }
    /// Node slots of all bodies.
    std::uint64_t slots() const { return slots_; }
    /// Defines for kernels that include node.clh: the geometry and the chunk size.
    Defines defines(std::uint32_t group_size) const;

    const Buffer& tree_table() const { return tree_table_; }   ///< TREE_WORDS words per body
    const Buffer& level_table() const { return level_table_; } ///< LEVEL_WORDS words per level

private:
    /// A row of the tree table (node.clh).
    struct Tree {
        std::uint32_t nodes = 0, levels = 0, level_count_and_block = 0, items = 0;
    };
    /// One launch of refit_strips: jobs of one level, those of moving bodies first.
    struct Strip {
        std::uint32_t level, height, first_job, jobs, dynamic_jobs;
    };

    void do_refit(const Frame& frame, bool all) override;
    void do_take(const Subdomain&) override;
    const Buffer& do_volumes() const override { return volumes_; }
    const Buffer& do_nodes() const override { return nodes_; }
    std::size_t do_bytes() const override;

    Defines refit_defines() const;
    void lay_out();
    void plan_strips();
    void plan_strip(std::uint32_t level, bool fixed, std::uint32_t top);
    void upload_static();
    void upload_jobs();
    void mask_skipped(const Frame& frame);
    void upload_masked();
    void launch_strips(bool all);
    void launch_tops(bool all);

    const Bodies& bodies_;
    Device& device_;
    std::uint32_t leaves_;
    std::uint32_t group_size_;
    RefitShape shape_;
    std::vector<std::vector<Level>> mesh_levels_;
    std::vector<std::uint32_t> level_rows_;
    std::vector<Tree> trees_;
    std::vector<std::uint32_t> jobs_;
    std::vector<Strip> strips_;
    std::uint32_t first_top_level_ = 1; ///< the first level that refit_tops refits
    std::uint32_t ordered_bodies_ = 0;  ///< number of bodies in body_order_
    std::uint32_t moving_bodies_ = 0;   ///< number of moving bodies, which come first in body_order_
    std::uint64_t slots_ = 0;
    bool fresh_ = true;                               ///< whether the next refit includes fixed bodies
    std::vector<std::vector<std::uint32_t>> skipped_; ///< by body: tetrahedra that the last frame skips
    MaskedElements masked_;                           ///< plan for skipped_
    Buffer nodes_, volumes_, tree_table_, level_table_, job_table_, body_order_;
    Buffer masked_rows_, masked_starts_;
    KernelOf<kernels::refit::RefitStrips> strips_kernel_;
    KernelOf<kernels::refit::RefitTops> tops_kernel_;
    KernelOf<kernels::refit::EmptyNodes> empty_kernel_;
};

} // namespace tandem
