// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/growable_buffer.h"
#include "algorithms/gproximity/balance.cl.h"
#include "algorithms/gproximity/gproximity.cl.h"
#include "algorithms/gproximity/gproximity_settings.h"
#include "algorithms/hierarchy/chunk_trees.h"
#include "algorithms/pipeline/stages.h"

namespace tandem {

/// gProximity's walk: queues of node pairs, one per work-group, balanced between launches.
class QueueWalker : public Walker {
public:
    /// `trees` must have one chunk per body. Both arguments must outlive this object.
    QueueWalker(const ChunkTrees& trees, const BuildContext& context);

protected:
    Device& device() const { return trees_.bodies().device(); }
    const QueueSizes& sizes() const { return sizes_; }
    const Buffer& idle() const { return idle_; }     ///< counter of idle groups
    const Buffer& counts() const { return counts_; } ///< items in each queue

private:
    void do_compile(const WalkBuild& build) override;
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status& status) override;
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    /// Sets the counter of idle groups to 0 before a launch. do_after_launch runs after each launch.
    virtual void do_clear_idle();
    virtual void do_after_launch() {}

    /// Bytes of one of the two arrays of queues.
    std::uint64_t queue_bytes() const;
    /// Capacity of each queue in items.
    std::uint32_t queue_capacity() const { return queues_.capacity(); }
    /// Maximum number of items in all queues together.
    std::uint64_t total_capacity() const;
    /// Queues that are walked, and those to which balancing moves their items.
    const Buffer& items() const { return queues_.buffer(side_); }
    const Buffer& target_items() const { return queues_.buffer(1 - side_); }
    void seed(const WalkTask& task, std::uint32_t first, std::uint32_t most);
    void upload_whole_queues(std::uint32_t first, std::uint32_t count);
    bool walk_batch(const WalkTask& task, std::uint32_t first, std::uint32_t count);
    void traverse(const WalkTask& task);
    void plan_and_move();
    std::array<std::uint32_t, 2> balance();

    const ChunkTrees& trees_;
    LaunchShape shape_;
    QueueSizes sizes_;
    bool short_of_queue_ = false;
    std::uint64_t balances_ = 0;
    GrowableBuffer queues_; ///< two arrays of queues, one column each; row i: item i of every queue
    std::size_t side_ = 0;  ///< the column of items()
    Buffer counts_, starts_, totals_, idle_;
    KernelOf<kernels::balance::ScatterRoots> scatter_;
    KernelOf<kernels::gproximity::TraverseQueues> traverse_;
    KernelOf<kernels::balance::PlanBalance> plan_;
    // One of them, by the method of balancing.
    KernelOf<kernels::balance::MoveBalance> move_;
    KernelOf<kernels::balance::MoveBalanceSerially> move_serially_;
};

/// Counters of this walk, in addition to those of every walk.
std::span<const Counter> queue_counters();

} // namespace tandem
