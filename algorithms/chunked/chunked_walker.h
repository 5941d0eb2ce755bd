// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/growable_buffer.h"
#include "algorithms/chunked/chunked.cl.h"
#include "algorithms/chunked/chunked_parameters.h"
#include "algorithms/chunked/seeds.cl.h"
#include "algorithms/hierarchy/chunk_trees.h"
#include "algorithms/pipeline/stages.h"

namespace tandem {

/// Walk of the chunked static scheduler. Seeds are made on the device. Then one launch per level runs, from
/// the highest level at which any pair of the scene's meshes has seeds.
class ChunkedWalker : public Walker {
public:
    /// Both arguments must outlive this object.
    ChunkedWalker(const ChunkTrees& trees, const BuildContext& context);

protected:
    /// The rule of seed_level in seeds.clh, on the host.
    std::uint32_t seed_level(std::uint32_t a, std::uint32_t b, std::uint64_t pair_count) const;
    /// Enqueues the walks of a level: its own seeds, given by the starts, and those handed down to it.
    void traverse(const WalkTask& task, std::uint32_t level, std::uint32_t pair_capacity);
    /// Reserves starts for `pairs` body pairs; existing starts are lost.
    void reserve_starts(std::uint64_t pairs);

    const ChunkTrees& trees() const { return trees_; }
    Device& device() const { return trees_.bodies().device(); }
    std::uint32_t top_level() const { return top_level_; }
    const GrowableBuffer& starts() const { return starts_; }
    /// Seeds handed down to a level or made by the host; rows of SEED_WORDS words.
    const Buffer& handed(std::uint32_t level) const { return handed_.buffer(level % 2); }
    /// Maximum number of seeds handed down to a level.
    std::uint32_t handed_capacity() const { return handed_.capacity(); }
    /// Grows this capacity; existing seeds are lost. Throws OutOfMemory.
    void grow_handed(std::uint64_t seeds) { handed_.grow(seeds); }

private:
    void do_compile(const WalkBuild& build) override;
    void do_launch(const WalkTask& task) override;
    bool is_in_groups() const { return schedule_ == chunked_parameters::Schedule::group; }
    std::optional<std::vector<Limit>> do_limits() const override;
    bool do_grow(const Status& status) override;
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    /// The level at which a pair of bodies is seeded in a frame of `pair_count` body pairs, if that level is
    /// launched.
    std::uint32_t wanted_level(std::uint32_t a, std::uint32_t b, std::uint64_t pair_count) const;
    void find_top_level(SelfPairs self);
    /// Counts the seeds of every body pair and level, then turns the counts into starts.
    void make_seeds(const WalkTask& task);

    const ChunkTrees& trees_;
    LaunchShape shape_;
    std::int64_t threshold_; ///< 0: target_ divided by the number of body pairs
    std::int64_t target_;
    chunked_parameters::Schedule schedule_;
    chunked_parameters::Descent descent_;
    bool root_test_;
    std::uint32_t top_level_ = 0; ///< highest level at which any pair of the scene's meshes has seeds
    GrowableBuffer handed_;       ///< seeds handed down to even and odd levels, one column each
    GrowableBuffer starts_;
    KernelOf<kernels::seeds::CountSeeds> count_kernel_;
    KernelOf<kernels::seeds::ScanSeeds> scan_kernel_;
    // One of them, by the schedule.
    KernelOf<kernels::chunked::Traverse> traverse_kernel_;
    KernelOf<kernels::chunked::TraverseInGroups> groups_kernel_;
};

} // namespace tandem
