// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/gproximity/gproximity_settings.h"
#include "algorithms/hierarchy/chunk_trees.h"
#include "algorithms/steps.h"

namespace tandem {

/// gProximity's walk: queues of node pairs, one for each work-group, balanced between launches.
class QueueWalker : public Walker {
public:
    /// `trees` of one chunk a body. Both must outlive this.
    QueueWalker(const ChunkTrees& trees, const Ground& ground);

protected:
    Device& device() const { return trees_.bodies().device(); }
    const QueueSizes& sizes() const { return sizes_; }
    const Buffer& idle() const { return idle_; }     ///< the counter of idle groups
    const Buffer& counts() const { return counts_; } ///< items in each queue

private:
    void do_compile(const WalkBuild& build) override;
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status& status) override;
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    /// Sets the counter of idle groups to 0 before a launch; what else happens after one.
    virtual void do_clear_idle();
    virtual void do_after_launch() {}

    /// Bytes of one of the two arrays of queues.
    std::uint64_t queue_bytes() const;
    std::uint64_t queue_room() const;
    void reserve_queues(std::uint32_t capacity);
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
    std::array<Buffer, 2> items_; ///< ping and pong
    Buffer counts_, starts_, totals_, idle_;
    Kernel scatter_, traverse_, plan_, move_;
};

/// Counters of this walk beside those of every walk.
std::span<const Counter> queue_counters();

} // namespace tandem
