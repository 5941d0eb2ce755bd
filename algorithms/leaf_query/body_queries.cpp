// SPDX-License-Identifier: MIT
#include "algorithms/leaf_query/body_queries.h"

#include "algorithms/hierarchy/queries.h"
#include "algorithms/kernels/sources.h"

#include <algorithm>

namespace tandem {

BodyQueries::BodyQueries(const ChunkTrees& trees, LaunchShape shape, bool has_self)
    : trees_(trees), shape_(shape) {
    const auto queries = most_queries(trees.bodies(), has_self);
    blocks_ = std::max(1u, (queries + shape.group_size - 1) / shape.group_size);
}

void BodyQueries::do_compile(const WalkBuild& build) {
    auto defines = trees_.defines(shape_.group_size);
    build.add_to(defines);
    compile_kernel(trees_.bodies().device(), kernel_, defines);
}

void BodyQueries::do_launch(const WalkTask& task) {
    const auto& bodies = trees_.bodies();
    const StageScope scope(bodies.device(), Stage::traverse);
    const auto turns = std::uint64_t{task.most_pairs()} * blocks_;
    const Grid grid{std::min<std::uint64_t>(shape_.groups, turns), shape_.group_size};
    const kernels::body_query::QueryLeaves arguments{.nodes = trees_.nodes(),
                                                     .trees = trees_.tree_table(),
                                                     .bodies = bodies.row_table(),
                                                     .ids = bodies.ids(),
                                                     .tetrahedra = bodies.topology(),
                                                     .pairs = task.body_pairs,
                                                     .pair_capacity = task.pair_capacity,
                                                     .blocks = blocks_,
                                                     .found = task.answer.pairs.buffer(),
                                                     .capacity = task.answer.pairs.capacity(),
                                                     .status = task.status.buffer()};
    bodies.device().launch(kernel_, grid, arguments);
}

void BodyQueries::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    work[counters::bvtt_nodes.name] += status.counter(STATUS_BVTT_NODES);
    work[counters::seeds.name] += status.counter(STATUS_SEEDS);
}

} // namespace tandem
