// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/growable_buffer.h"
#include "algorithms/expected_groups.h"
#include "algorithms/hierarchy/tile_trees.h"
#include "algorithms/stages.h"

#include <optional>

namespace tandem {

namespace tiled_parameters {
inline constexpr Setting<std::int64_t> tile_pair_capacity{"tile_pair_capacity", 262144,
                                                          ValueRange{1, parameters::word_limit}, "",
                                                          "initial capacity of a level in pairs of tiles"};
/// The value that 0 selects is measured: results/h200/README.md.
inline constexpr Setting<std::int64_t> most_seeds{"most_seeds", 0, ValueRange{0, std::int64_t{1} << 24}, "",
                                                  "maximum number of pairs of tiles with which bodies "
                                                  "start below their tops; 0: 16384 on GPUs, 256 elsewhere"};
} // namespace tiled_parameters

/// Counters in addition to those of every walk.
namespace tiled_counters {
inline constexpr Counter upper_tests{"upper_tests", "boxes", "tested node pairs above tetrahedra"};
inline constexpr Counter leaf_tile_pairs{"leaf_tile_pairs", "pairs of tiles",
                                         "pairs of tiles of tetrahedra that were tested, at least by their "
                                         "roots"};
} // namespace tiled_counters

/// Walks pairs of tiles with one launch per level, from the highest level of any body down to candidate
/// pairs.
class TiledWalker final : public Walker {
public:
    /// Launches groups of `shape`. `trees` and `context` must outlive this object.
    TiledWalker(TileTrees& trees, const BuildContext& context, LaunchShape shape);

private:
    void do_compile(const WalkBuild& build) override;
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status& status) override;
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    /// Pairs of tiles that the level above finds. The highest level has only those with which body pairs
    /// start.
    const GrowableBuffer& list(std::uint32_t level) const {
        return lists_[std::min<std::size_t>(level, lists_.size() - 1)];
    }
    /// The grid of a level's launch: few groups if the last frame had few pairs.
    Grid grid(std::uint32_t level);
    void launch_upper(const WalkTask& task, std::uint32_t level);
    void launch_leaves(const WalkTask& task);

    TileTrees& trees_;
    LaunchShape shape_;
    std::vector<GrowableBuffer> lists_; ///< by level
    /// By level: pairs in the last frame, empty before the first one, and the groups for them.
    struct Expected {
        std::optional<std::uint64_t> pairs;
        ExpectedGroups groups;
    };
    std::vector<Expected> expected_;
    Kernel upper_kernel_, leaf_kernel_;
};

} // namespace tandem
