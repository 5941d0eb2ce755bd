// SPDX-License-Identifier: MIT
#include "algorithms/tiled/tiled_walker.h"

#include "algorithms/sources.h"

namespace tandem {

void TiledWalker::do_compile(const WalkBuild& build) {
    const auto defines = levels_.defines(build);
    levels_.compile(defines);
    leaf_kernel_ = trees_.bodies().device().compile(kernel_source("algorithms/tiled/tiled.cl"),
                                                    "walk_leaf_tiles", defines);
}

bool TiledWalker::do_grow(const Status& status) {
    levels_.expect(status);
    trees_.expect_tile_pairs(levels_.expected_leaf_pairs());
    return levels_.grow(status);
}

void TiledWalker::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    levels_.report(status, work);
}

void TiledWalker::launch_leaves(const WalkTask& task) {
    const auto& bodies = trees_.bodies();
    const auto& shapes = trees_.shapes();
    const auto& incidence = trees_.incidence();
    const std::array<Argument, 22> arguments{trees_.leaves(),
                                             trees_.roots(),
                                             trees_.tile_table(),
                                             trees_.tops(),
                                             task.body_pairs,
                                             task.pair_capacity,
                                             trees_.begins(0),
                                             levels_.list(0).buffer(),
                                             levels_.capacity(0),
                                             shapes.starts(),
                                             shapes.vertex_numbers(),
                                             shapes.corners(),
                                             bodies.row_table(),
                                             bodies.poses(),
                                             bodies.vertices(),
                                             bodies.ids(),
                                             incidence.starts(),
                                             incidence.partners(),
                                             incidence.masks(),
                                             task.answer.pairs.buffer(),
                                             task.answer.pairs.capacity(),
                                             task.status.buffer()};
    bodies.device().launch(leaf_kernel_, levels_.grid(0), arguments);
}

void TiledWalker::do_launch(const WalkTask& task) {
    const StageScope scope(trees_.bodies().device(), Stage::traverse);
    levels_.launch(task);
    if (trees_.has_touched()) trees_.bound_touched();
    launch_leaves(task);
}

} // namespace tandem
