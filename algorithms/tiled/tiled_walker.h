// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/tiled/tile_levels.h"

namespace tandem {

/// Walks pairs of tiles with one launch per level, from the highest level of any body down to candidate
/// pairs.
class TiledWalker final : public Walker {
public:
    /// Launches groups of `shape`. `trees` and `context` must outlive this object.
    TiledWalker(TileTrees& trees, const BuildContext& context, LaunchShape shape)
        : trees_(trees), levels_(trees, context, shape) {}

private:
    void do_compile(const WalkBuild& build) override;
    void do_launch(const WalkTask& task) override;
    std::optional<std::vector<Limit>> do_limits() const override { return levels_.limits(); }
    bool do_grow(const Status& status) override;
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    void launch_leaves(const WalkTask& task);

    TileTrees& trees_;
    TileLevels levels_;
    KernelOf<kernels::tiled::WalkLeafTiles> leaf_kernel_;
};

} // namespace tandem
