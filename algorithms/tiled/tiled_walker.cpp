// SPDX-License-Identifier: MIT
#include "algorithms/tiled/tiled_walker.h"

#include "algorithms/kernels/sources.h"

namespace tandem {

void TiledWalker::do_compile(const WalkBuild& build) {
    const auto defines = levels_.defines(build);
    levels_.compile(defines);
    compile_kernel(trees_.bodies().device(), leaf_kernel_, defines);
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
    const kernels::tiled::WalkLeafTiles arguments{.leaves = trees_.leaves(),
                                                  .roots = trees_.roots(),
                                                  .tiles = trees_.tile_table(),
                                                  .tops = trees_.tops(),
                                                  .pairs = task.body_pairs,
                                                  .pair_capacity = task.pair_capacity,
                                                  .begins = trees_.begins(0),
                                                  .list = levels_.list(0).buffer(),
                                                  .list_capacity = levels_.capacity(0),
                                                  .starts = shapes.starts(),
                                                  .vertex_numbers = shapes.vertex_numbers(),
                                                  .corners = shapes.corners(),
                                                  .bodies = bodies.row_table(),
                                                  .poses = bodies.poses(),
                                                  .vertices = bodies.vertices(),
                                                  .margin = reach_of_margin(bodies.geometry()),
                                                  .ids = bodies.ids(),
                                                  .incident_starts = incidence.starts(),
                                                  .incident_partners = incidence.partners(),
                                                  .incident_masks = incidence.masks(),
                                                  .found = task.answer.pairs.buffer(),
                                                  .capacity = task.answer.pairs.capacity(),
                                                  .status = task.status.buffer()};
    bodies.device().launch(leaf_kernel_, levels_.grid(0), arguments);
}

void TiledWalker::do_launch(const WalkTask& task) {
    const StageScope scope(trees_.bodies().device(), Stage::traverse);
    levels_.launch(task);
    if (trees_.has_touched()) trees_.bound_touched();
    launch_leaves(task);
}

} // namespace tandem
