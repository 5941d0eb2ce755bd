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
                                                          "pairs of tiles a level has room for at first"};
/// What 0 stands for is measured: results/h200/README.md.
inline constexpr Setting<std::int64_t> most_seeds{"most_seeds", 0, ValueRange{0, std::int64_t{1} << 24}, "",
                                                  "bodies begin as far below their tops as that makes no "
                                                  "more pairs of tiles; 0: 16384 on GPUs, 256 elsewhere"};
} // namespace tiled_parameters

/// Beside those of every walk.
namespace tiled_counters {
inline constexpr Counter upper_tests{"upper_tests", "boxes",
                                     "of the node pairs tested those above tetrahedra"};
inline constexpr Counter leaf_tile_pairs{"leaf_tile_pairs", "pairs of tiles",
                                         "pairs of tiles of tetrahedra that were tested, by their roots at "
                                         "least"};
} // namespace tiled_counters

/// Pairs of tiles, a launch a level from the highest of any body down to candidate pairs.
class TiledWalker final : public Walker {
public:
    /// Launches groups of `shape`. Both others must outlive this.
    TiledWalker(const TileTrees& trees, const BuildContext& ground, LaunchShape shape);

private:
    void do_compile(const WalkBuild& build) override;
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status& status) override;
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    /// The pairs of tiles of a level; of the highest one there is none but those that body pairs begin with.
    const GrowableBuffer& list(std::uint32_t level) const {
        return lists_[std::min<std::size_t>(level, lists_.size() - 1)];
    }
    /// The groups of a level's launch: few where the last frame had few pairs.
    Grid grid(std::uint32_t level);
    void launch_upper(const WalkTask& task, std::uint32_t level);
    void launch_leaves(const WalkTask& task);

    const TileTrees& trees_;
    LaunchShape shape_;
    std::vector<GrowableBuffer> lists_; ///< by level
    /// Of a level: pairs in the last frame, nothing before the first, and the groups for them.
    struct Expected {
        std::optional<std::uint64_t> pairs;
        ExpectedGroups groups;
    };
    std::vector<Expected> expected_;
    Kernel upper_kernel_, leaf_kernel_;
};

} // namespace tandem
