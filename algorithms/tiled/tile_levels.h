// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/growable_buffer.h"
#include "algorithms/kernels/expected_groups.h"
#include "algorithms/hierarchy/tile_trees.h"
#include "algorithms/pipeline/stages.h"
#include "algorithms/tiled/tiled.cl.h"
#include "algorithms/pipeline/walker.h"

#include <optional>

namespace tandem {

/// The levels of a tiled walk above its tetrahedra: one launch per level, from the highest level of any body
/// down, each of which finds the pairs of tiles of the next lower level.
class TileLevels {
public:
    /// Launches groups of `shape`. The initial capacity of a level is setting tile_pair_capacity. `trees` and
    /// `context` must outlive this object. Throws OutOfMemory.
    TileLevels(TileTrees& trees, const BuildContext& context, LaunchShape shape);

    /// Compiles the kernel with these defines, or reuses a compiled one.
    void compile(const Defines& defines);
    /// Defines of all kernels of the walk.
    Defines defines(const WalkBuild& build) const;
    /// Enqueues the launches of all levels above 0. The status gets the numbers of pairs by level
    /// (tile_pairs.clh). Throws InputError if 32 bits cannot number the pairs of tiles that body pairs on the
    /// host begin with.
    void launch(const WalkTask& task);

    /// Sets what a level's grid expects to the counts of the last walk.
    /// Throws InputError as launch(), for body pairs that the device has found.
    void expect(const Status& status);
    /// Grows the lists that the last walk overflowed. Returns true if it must run again. Throws OutOfMemory.
    bool grow(const Status& status);
    /// As Walker::limits().
    std::vector<Limit> limits() const;
    /// Adds the counts of a counting walk.
    void report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const;

    /// The grid of a level's launch: few groups if the last walk had few pairs.
    Grid grid(std::uint32_t level);
    /// The pairs of tiles that the level above finds. The highest level has only those with which body pairs
    /// start.
    const GrowableBuffer& list(std::uint32_t level) const {
        return lists_[std::min<std::size_t>(level, lists_.size() - 1)];
    }
    /// The capacity of a level's list in pairs; 0 for the highest level.
    std::uint32_t capacity(std::uint32_t level) const {
        return level + 1 < trees_.walked_levels() ? list(level).capacity() : 0;
    }
    /// Pairs of tiles of level 0 in the last walk that expect() had.
    std::uint64_t expected_leaf_pairs() const { return *expected_[0].pairs; }

private:
    void check_start_pairs(std::uint64_t body_pairs) const;
    void launch_level(const WalkTask& task, std::uint32_t level);

    TileTrees& trees_;
    LaunchShape shape_;
    std::vector<GrowableBuffer> lists_; ///< by level
    /// By level: pairs in the last walk, empty before the first one, and the groups for them.
    struct Expected {
        std::optional<std::uint64_t> pairs;
        ExpectedGroups groups;
    };
    std::vector<Expected> expected_;
    KernelOf<kernels::tiled::WalkUpperTiles> kernel_;
};

} // namespace tandem
